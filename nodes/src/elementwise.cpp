#include "elementwise.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "signal_function.hpp"

namespace spikeloop {

namespace {

class Threshold final : public SignalFunction {
 public:
  explicit Threshold(const NodeSetup& setup)
      : SignalFunction(setup),
        threshold_(setup.parameters.number("threshold")),
        is_heaviside_(setup.parameters.boolean("is_heaviside")),
        scale_(setup.parameters.number("scale")),
        shift_(setup.parameters.number("shift")) {
    require_equal_widths(setup);
  }

 private:
  void apply(std::span<const double> x, std::span<double> y) const override {
    std::ranges::transform(x, y.begin(), [this](double value) {
      const double above = is_heaviside_ ? 1.0 : value;
      return scale_ * (value < threshold_ ? 0.0 : above) + shift_;
    });
  }

  double threshold_;
  bool is_heaviside_;
  double scale_;
  double shift_;
};

class Sigmoid final : public SignalFunction {
 public:
  explicit Sigmoid(const NodeSetup& setup)
      : SignalFunction(setup),
        scale_(setup.parameters.number("scale")),
        slope_(setup.parameters.number("slope")),
        x_offset_(setup.parameters.number("x_offset")),
        y_offset_(setup.parameters.number("y_offset")) {
    require_equal_widths(setup);
  }

 private:
  void apply(std::span<const double> x, std::span<double> y) const override {
    std::ranges::transform(x, y.begin(), [this](double value) {
      return scale_ / (1.0 + std::exp(x_offset_ - slope_ * value)) + y_offset_;
    });
  }

  double scale_;
  double slope_;
  double x_offset_;
  double y_offset_;
};

ParameterDescription number(std::string name, std::string value, std::string text) {
  return {.name = std::move(name),
          .unit = "1",
          .default_value = std::move(value),
          .text = std::move(text)};
}

}  // namespace

NodeClass threshold_class() {
  NodeDescription description = signal_function_description(
      {number("threshold", "0", "Values from here on are above it"),
       {.name = "is_heaviside",
        .type = ParameterType::boolean,
        .default_value = "true",
        .text = "Values above the threshold become 1; false: they stay"},
       number("scale", "1", "Factor of the result"),
       number("shift", "0", "Added to the scaled result")});
  description.name = "threshold";
  description.text = "Channels below a threshold become 0, the others 1 or stay as they are";
  description.source = "music-adapters, threshold adapter";
  return {description, [](const NodeSetup& setup) { return std::make_unique<Threshold>(setup); }};
}

NodeClass sigmoid_class() {
  NodeDescription description = signal_function_description(
      {number("scale", "1", "Height of the curve"), number("slope", "1", "Factor of the input"),
       number("x_offset", "0", "Taken from the input after its factor"),
       number("y_offset", "0", "Added to the result")});
  description.name = "sigmoid";
  description.text = "The logistic function of each channel";
  description.source = "music-adapters, sigmoid adapter";
  return {description, [](const NodeSetup& setup) { return std::make_unique<Sigmoid>(setup); }};
}

}  // namespace spikeloop
