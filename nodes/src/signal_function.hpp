// What nodes that map one continuous signal onto another have in common.
#pragma once

#include <span>
#include <vector>

#include "input_policy.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// The output is a function of the input's present value: computed anew when the input has a new
/// revision, idle while it has none, invalid while the input is.
class SignalFunction : public Node {
 public:
  explicit SignalFunction(const NodeSetup& setup);

  void step(const Step& step) final;
  /// updates, and those of the input policy
  std::vector<Counter> counters() const final;

 protected:
  virtual void apply(std::span<const double> x, std::span<double> y) const = 0;

 private:
  InputPolicy policy_;
  std::vector<double> held_;  // each channel's last good value
  std::uint64_t revision_ = 0;
  std::uint64_t updates_ = 0;
};

/// Ports `in` and `out`, both continuous; these parameters and then those of the input policy.
NodeDescription signal_function_description(std::vector<ParameterDescription> parameters = {});

/// @throws ConfigurationError naming both widths when they differ.
void require_equal_widths(const NodeSetup& setup);

}  // namespace spikeloop
