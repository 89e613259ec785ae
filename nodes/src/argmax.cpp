// `argmax`: which channel is the largest.
#include <algorithm>
#include <memory>

#include "signal_function.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

class Argmax final : public SignalFunction {
 public:
  using SignalFunction::SignalFunction;

 private:
  void apply(std::span<const double> x, std::span<double> y) const override {
    y[0] = static_cast<double>(std::ranges::max_element(x) - x.begin());
  }
};

}  // namespace

/// out[0] = index of the largest input, counted from 0; of equal ones the first.
NodeClass argmax_class() {
  NodeDescription description = signal_function_description();
  description.name = "argmax";
  description.text = "Index of the channel with the largest value";
  description.source = "music-adapters, argmax adapter";
  description.ports[1].width = WidthRule::fixed(1);
  description.ports[1].text = "The index, counted from 0; on a tie, the lowest";
  return {description, [](const NodeSetup& setup) { return std::make_unique<Argmax>(setup); }};
}

}  // namespace spikeloop
