// Multiplies its input; fails on purpose when asked to.
#include <stdexcept>

#include "spikeloop/core/plugin.hpp"

namespace {

using namespace spikeloop;

class Gain : public Node {
 public:
  static NodeDescription describe() {
    NodeDescription description;
    description.name = "gain";
    description.text = "output = gain * input, plus a spike for every negative value";
    description.ports = {
        {"in", PortKind::signal, Direction::input, {}, "values"},
        {"out", PortKind::signal, Direction::output, WidthRule::same_as(0), "values times gain"},
        {"negative", PortKind::spikes, Direction::output, WidthRule::same_as(0), "signs"}};
    ParameterDescription gain{"gain", ParameterType::number, "1", "2", -10, 10, {}, "the factor"};
    ParameterDescription mode{"mode", ParameterType::choice,         "",          "plain", 0,
                              0,      {"plain", "fail", "miscount"}, "what to do"};
    ParameterDescription weights{"weights", ParameterType::weights, "", "uniform", 0, 0, {},
                                 "unused"};
    description.parameters = {gain, mode, weights};
    return description;
  }

  explicit Gain(const NodeSetup& setup)
      : gain_(setup.parameters.number("gain")),
        fail_(setup.parameters.text("mode") == "fail"),
        miscount_(setup.parameters.text("mode") == "miscount"),
        weight_sum_(0) {
    if (setup.widths[0] > 4) {
      throw ConfigurationError("at most 4 channels");
    }
    for (const double weight : setup.parameters.weights("weights").values) {
      weight_sum_ += weight;
    }
  }

  void step(const Step& step) override {
    if (fail_) {
      throw std::runtime_error("asked to fail");
    }
    const auto in = step.signal_input();
    if (!in.valid() || in.revision == seen_) {
      return;
    }
    seen_ = in.revision;
    const auto out = step.signal_output();
    for (std::size_t i = 0; i < in.values.size(); ++i) {
      out.values()[i] = gain_ * in.values[i];
      if (in.values[i] < 0) {
        step.spike_output().emit(step.interval().end, static_cast<std::int32_t>(i));
      }
    }
    out.commit();
    ++revisions_;
  }

  std::vector<Counter> counters() const override {
    if (miscount_) {
      throw std::runtime_error("asked to miscount");
    }
    return {{"revisions", revisions_}, {"weight_sum", static_cast<std::uint64_t>(weight_sum_)}};
  }

 private:
  double gain_;
  bool fail_;
  bool miscount_;
  double weight_sum_;
  std::uint64_t seen_ = 0;
  std::uint64_t revisions_ = 0;
};

}  // namespace

SPIKELOOP_PLUGIN(Gain)
