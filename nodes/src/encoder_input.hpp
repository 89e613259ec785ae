// The input side that all rate-based encoders share: which rate each channel has from when on.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "input_policy.hpp"
#include "spike_schedule.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// Ports `in` (signal) and `out` (spikes, same width).
std::vector<PortDescription> encoder_ports();
/// `initial`, which every encoder has.
ParameterDescription initial_of_encoder_parameter();
/// Its value; nothing for `none`. @throws ConfigurationError when it is not a number, or outside
/// [-1, 1] unless `any_value`.
std::optional<double> initial_of_encoder(const Parameters& parameters, bool any_value);
/// rate_min, rate_max, initial, out_of_range, not_finite.
std::vector<ParameterDescription> encoder_parameters();

/// Maps x in [-1, 1] to the rate  rate_min + (x + 1) / 2 * (rate_max - rate_min)  (Weidel et al.
/// 2016, eq. 1).
class EncoderInput {
 public:
  /// @throws ConfigurationError when `initial` is not a number, or outside [-1, 1] unless
  /// out_of_range = pass.
  explicit EncoderInput(const NodeSetup& setup);

  /// Changes the rates of `schedule` at the step's begin if the input brings anything new. An input
  /// without a value means silence, or `initial` while no value has come yet.
  void update(const Step& step, SpikeSchedule& schedule);

  /// As Node::change(): rate_min, rate_max.
  void change(std::string_view parameter, double value);

  void append_counters(std::vector<Counter>& counters) const;

 private:
  /// The values after the policy; the first is channel `first`'s.
  std::span<const double> treated(std::span<const double> values, std::size_t first);

  double middle() const { return (rate_max_ + rate_min_) / 2; }      // Hz, the rate at 0
  double half_range() const { return (rate_max_ - rate_min_) / 2; }  // Hz, what 1 adds to it

  InputPolicy policy_;
  double rate_min_;
  double rate_max_;
  std::optional<double> initial_;
  bool begun_ = false;
  bool changed_ = false;  // since the last update
  std::uint64_t revision_ = 0;
  std::uint64_t rates_limited_ = 0;
  std::vector<double> treated_;
};

}  // namespace spikeloop
