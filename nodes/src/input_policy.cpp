#include "input_policy.hpp"

#include <fmt/format.h>

#include <limits>
#include <stdexcept>

namespace spikeloop {

void append_finite_input_policy(std::vector<ParameterDescription>& parameters) {
  parameters.push_back({.name = "not_finite",
                        .type = ParameterType::choice,
                        .default_value = "hold",
                        .choices = {"hold", "zero", "error"},
                        .text = "NaN or infinite input values: hold the channel's last finite "
                                "value (0 before the first), use 0, or end the run with an error"});
}

void append_encoder_input_policy(std::vector<ParameterDescription>& parameters) {
  parameters.push_back(
      {.name = "out_of_range",
       .type = ParameterType::choice,
       .default_value = "clip",
       .choices = {"clip", "pass", "error"},
       .text = "Input values outside [-1, 1], including infinity: clip, extrapolate (rates from 0 "
               "to 1 MHz), or end the run with an error"});
  append_finite_input_policy(parameters);
}

InputPolicy::InputPolicy(const NodeSetup& setup)
    : has_range_(setup.parameters.all().contains("out_of_range")) {
  if (has_range_) {
    const std::string& range = setup.parameters.text("out_of_range");
    range_ = range == "clip" ? Range::clip : range == "pass" ? Range::pass : Range::error;
  }
  const std::string& choice = setup.parameters.text("not_finite");
  not_finite_ = choice == "hold"   ? NotFinite::hold
                : choice == "zero" ? NotFinite::zero
                                   : NotFinite::error;
  limit_ = has_range_ ? 1.0 : std::numeric_limits<double>::max();
}

double InputPolicy::treat_unusual(double value, std::size_t channel) {
  if (std::isnan(value) || (std::isinf(value) && range_ == Range::pass)) {
    return treat_not_finite(value, channel);
  }
  switch (range_) {
    case Range::clip:
      ++clipped_count_;
      return std::copysign(1.0, value);
    case Range::pass:
      return value;
    case Range::error:
      break;
  }
  throw std::runtime_error(
      fmt::format("input channel {} has the value {}, outside [-1, 1]; scale the "
                  "signal before this node, or write out_of_range = clip",
                  channel, value));
}

double InputPolicy::treat_not_finite(double value, std::size_t channel) {
  switch (not_finite_) {
    case NotFinite::hold:
      ++not_finite_count_;
      return std::numeric_limits<double>::quiet_NaN();
    case NotFinite::zero:
      ++not_finite_count_;
      return 0.0;
    case NotFinite::error:
      break;
  }
  const double shown = std::isnan(value) ? std::fabs(value) : value;  // "nan", never "-nan"
  throw std::runtime_error(
      fmt::format("input channel {} has the value {}, which is not a number to work with; "
                  "mend its source, or write not_finite = hold",
                  channel, shown));
}

void InputPolicy::append_counters(std::vector<Counter>& counters) const {
  if (has_range_) {
    counters.push_back({"inputs_clipped", clipped_count_});
  }
  counters.push_back({"inputs_not_finite", not_finite_count_});
}

}  // namespace spikeloop
