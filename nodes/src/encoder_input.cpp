#include "encoder_input.hpp"

#include <fmt/format.h>

#include <cmath>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/number_or_word.hpp"

namespace spikeloop {

namespace {

constexpr double kUsual = 1.0;  // values within it need no policy

}  // namespace

ParameterDescription initial_of_encoder_parameter() {
  return {.name = "initial",
          .type = ParameterType::text,
          .default_value = "none",
          .text = "Input value before the first one arrives; none: no spikes"};
}

std::optional<double> initial_of_encoder(const Parameters& parameters, bool any_value) {
  const std::optional<double> value =
      number_or_word(parameters, "initial", "none",
                     "write a value from -1 to 1, or none for silence until the first input");
  if (value && !any_value && std::fabs(*value) > 1.0) {
    throw ConfigurationError(
        parameters.where("initial"),
        with_code(Code::out_of_bounds,
                  "key 'initial': {} is out of bounds; write a value from -1 to 1, or none for "
                  "silence until the first input",
                  *value));
  }
  return value;
}

std::vector<PortDescription> encoder_ports() {
  return {{"in", PortKind::signal, Direction::input, {}, "Values in [-1, 1], one per channel"},
          {"out", PortKind::spikes, Direction::output, WidthRule::same_as(0),
           "One neuron per channel"}};
}

std::vector<ParameterDescription> encoder_parameters() {
  std::vector<ParameterDescription> parameters;
  parameters.push_back({.name = "rate_min",
                        .unit = "Hz",
                        .default_value = "0",
                        .minimum = 0.0,
                        .maximum = SpikeSchedule::kFastest,
                        .text = "Firing rate at the input value -1",
                        .changeable = true});
  parameters.push_back({.name = "rate_max",
                        .unit = "Hz",
                        .default_value = "100",
                        .minimum = 0.0,
                        .maximum = SpikeSchedule::kFastest,
                        .text = "Firing rate at the input value 1",
                        .changeable = true});
  parameters.push_back(initial_of_encoder_parameter());
  append_encoder_input_policy(parameters);
  return parameters;
}

EncoderInput::EncoderInput(const NodeSetup& setup)
    : policy_(setup),
      rate_min_(setup.parameters.number("rate_min")),
      rate_max_(setup.parameters.number("rate_max")),
      initial_(initial_of_encoder(setup.parameters, policy_.passes())) {}

void EncoderInput::update(const Step& step, SpikeSchedule& schedule) {
  const SignalInput input = step.signal_input();
  const TimeNs now = step.interval().begin;
  if (input.valid()) {
    if (input.revision != revision_ || changed_) {
      const auto own = input.values.subspan(schedule.first(), schedule.channels());
      schedule.set_rates(now, own, middle(), half_range(), kUsual,
                         [&](std::span<const double> part, std::size_t first) {
                           return treated(part, schedule.first() + first);
                         });
    }
  } else if (initial_ && revision_ == 0 && (!begun_ || changed_)) {
    schedule.set_rates(now, [&](std::size_t) { return middle() + half_range() * *initial_; });
  } else if (revision_ != 0) {
    schedule.set_rates(now, [](std::size_t) { return 0.0; });
  }
  begun_ = true;
  changed_ = false;
  revision_ = input.revision;
}

std::span<const double> EncoderInput::treated(std::span<const double> values, std::size_t first) {
  if (all_within(values, kUsual)) {
    return values;  // as good values are, nothing is copied
  }
  treated_.resize(values.size());
  for (std::size_t c = 0; c < values.size(); ++c) {
    const double x = policy_.treat(values[c], first + c);
    const double rate = middle() + half_range() * x;
    if (std::fabs(x) > 1.0 && (rate < 0.0 || rate > SpikeSchedule::kFastest)) {
      ++rates_limited_;
    }
    treated_[c] = x;
  }
  return treated_;
}

void EncoderInput::change(std::string_view parameter, double value) {
  (parameter == "rate_min" ? rate_min_ : rate_max_) = value;
  changed_ = true;
}

void EncoderInput::append_counters(std::vector<Counter>& counters) const {
  policy_.append_counters(counters);
  counters.push_back({"rates_limited", rates_limited_});
}

}  // namespace spikeloop
