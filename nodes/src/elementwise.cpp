// `threshold`, `sigmoid`, `clip` and `normalise`: functions of each channel by itself.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "parameter_checks.hpp"
#include "signal_function.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

namespace {

// One function of a value, applied to every channel.
template <typename Function>
class Elementwise final : public SignalFunction {
 public:
  Elementwise(const NodeSetup& setup, Function function)
      : SignalFunction(setup), function_(std::move(function)) {}

 private:
  void apply(std::span<const double> x, std::span<double> y) const override {
    std::ranges::transform(x, y.begin(), function_);
  }

  Function function_;
};

template <typename Function>
std::unique_ptr<Node> elementwise(const NodeSetup& setup, Function function) {
  return std::make_unique<Elementwise<Function>>(setup, std::move(function));
}

std::unique_ptr<Node> make_threshold(const NodeSetup& setup) {
  const Parameters& given = setup.parameters;
  return elementwise(
      setup, [threshold = given.number("threshold"), is_heaviside = given.boolean("is_heaviside"),
              scale = given.number("scale"), shift = given.number("shift")](double value) {
        const double above = is_heaviside ? 1.0 : value;
        return scale * (value < threshold ? 0.0 : above) + shift;
      });
}

std::unique_ptr<Node> make_sigmoid(const NodeSetup& setup) {
  const Parameters& given = setup.parameters;
  return elementwise(setup, [scale = given.number("scale"), slope = given.number("slope"),
                             x_offset = given.number("x_offset"),
                             y_offset = given.number("y_offset")](double value) {
    return scale / (1.0 + std::exp(x_offset - slope * value)) + y_offset;
  });
}

std::unique_ptr<Node> make_clip(const NodeSetup& setup) {
  const Parameters& given = setup.parameters;
  require_at_most(given, "min", "max");
  return elementwise(setup, [low = given.number("min"), high = given.number("max")](double value) {
    return std::clamp(value, low, high);
  });
}

std::unique_ptr<Node> make_normalise(const NodeSetup& setup) {
  const Parameters& given = setup.parameters;
  require_below(given, "in_min", "in_max");
  const double low = given.number("in_min");
  const double high = given.number("in_max");
  const double most = std::numeric_limits<double>::max();
  const bool clips = given.boolean("clip");
  return elementwise(
      setup, [low, high, most, least_in = clips ? low : -most, most_in = clips ? high : most,
              from = given.number("out_min"),
              span = given.number("out_max") - given.number("out_min")](double value) {
        // Huge inputs stay finite: neither part nor result may overflow.
        const double in = std::clamp(value, least_in, most_in);
        const double part = std::clamp((in - low) / (high - low), -most, most);
        return std::clamp(from + part * span, -most, most);
      });
}

NodeDescription elementwise_description(std::vector<ParameterDescription> parameters) {
  NodeDescription description = signal_function_description(std::move(parameters));
  description.ports[1].width = WidthRule::same_as(0);
  return description;
}

ParameterDescription number(std::string name, std::string value, std::string text) {
  return {.name = std::move(name),
          .unit = "1",
          .default_value = std::move(value),
          .text = std::move(text)};
}

}  // namespace

/// out = scale * (in < threshold ? 0 : is_heaviside ? 1 : in) + shift
NodeClass threshold_class() {
  NodeDescription description = elementwise_description(
      {number("threshold", "0", "Smallest value that counts as above the threshold"),
       {.name = "is_heaviside",
        .type = ParameterType::boolean,
        .default_value = "true",
        .text = "true: values above the threshold become 1; false: they are unchanged"},
       number("scale", "1", "Factor applied to the result"),
       number("shift", "0", "Added to the scaled result")});
  description.name = "threshold";
  description.text =
      "Sets values below a threshold to 0; sets the others to 1 or leaves them unchanged";
  description.source = "music-adapters, threshold adapter";
  return {description, make_threshold};
}

/// out = scale / (1 + exp(x_offset - slope * in)) + y_offset
NodeClass sigmoid_class() {
  NodeDescription description = elementwise_description(
      {number("scale", "1", "Height of the curve"),
       number("slope", "1", "Factor applied to the input"),
       number("x_offset", "0", "Subtracted from the input after the factor"),
       number("y_offset", "0", "Added to the result")});
  description.name = "sigmoid";
  description.text = "Logistic function of each channel";
  description.source = "music-adapters, sigmoid adapter";
  return {description, make_sigmoid};
}

/// out = min(max(in, min), max)
NodeClass clip_class() {
  constexpr double kMost = 1e300;
  NodeDescription description =
      elementwise_description({number_parameter("min", "1", "-1", -kMost, kMost, "Lower bound"),
                               number_parameter("max", "1", "1", -kMost, kMost, "Upper bound")});
  description.name = "clip";
  description.text = "Limits each channel to a range";
  description.source = "y = min(max(x, min), max)";
  return {description, make_clip};
}

/// out = out_min + (in - in_min) / (in_max - in_min) * (out_max - out_min); with `clip`, the input
/// is taken between in_min and in_max. out_min may be the larger one: that turns the range round.
NodeClass normalise_class() {
  constexpr double kMost = 1e100;
  NodeDescription description = elementwise_description(
      {number_parameter("in_min", "1", "0", -kMost, kMost, "Input value that is mapped to out_min"),
       number_parameter("in_max", "1", "1", -kMost, kMost, "Input value that is mapped to out_max"),
       number_parameter("out_min", "1", "-1", -kMost, kMost, "Output value for in_min"),
       number_parameter("out_max", "1", "1", -kMost, kMost, "Output value for in_max"),
       {.name = "clip",
        .type = ParameterType::boolean,
        .default_value = "true",
        .text = "true: clip inputs to the range; false: extrapolate"}});
  description.name = "normalise";
  description.text = "Maps one range of values linearly onto another";
  description.source = "y = out_min + (x - in_min) / (in_max - in_min) (out_max - out_min)";
  return {description, make_normalise};
}

}  // namespace spikeloop
