// The values that a continuous input holds, channel by channel, and when they change.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "input_policy.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// Each channel's last good value, or NaN while it has none: no good value has come yet, or the
/// input is invalid. A value that is written again is not a change, so that a signal gives the same
/// result whether or not it is revised at every tick.
class HeldInput {
 public:
  /// `initial` is held by all channels until the input's first value, if it has none at the start.
  explicit HeldInput(const NodeSetup& setup, std::optional<double> initial = std::nullopt)
      : policy_(setup), initial_(initial), values_(setup.widths[0], kNone) {}

  /// Takes in what the step's input holds from the step's begin on; calls `changed(channel,
  /// before)` for every channel whose value is another one now. True when the input was revised or
  /// has become invalid.
  template <typename Changed>
  bool update(const Step& step, Changed&& changed) {
    const SignalInput input = step.signal_input();
    if (input.valid() && input.revision != revision_) {
      for (std::size_t c = 0; c < values_.size(); ++c) {
        const double value = policy_.treat(input.values[c], c);
        if (!std::isnan(value)) {
          set(c, value, changed);
        }
      }
    } else if (!input.valid() && (revision_ != 0 || (!begun_ && initial_))) {
      for (std::size_t c = 0; c < values_.size(); ++c) {
        set(c, begun_ ? kNone : *initial_, changed);
      }
    }
    const bool revised = input.revision != revision_;
    begun_ = true;
    revision_ = input.revision;
    return revised;
  }
  bool update(const Step& step) {
    return update(step, [](std::size_t, double) {});
  }

  double operator[](std::size_t channel) const { return values_[channel]; }
  std::size_t channels() const { return values_.size(); }
  /// All values; 0 for channels without one, as nodes that map signals take them.
  void copy_to(std::span<double> values) const {
    for (std::size_t c = 0; c < values_.size(); ++c) {
      values[c] = std::isnan(values_[c]) ? 0.0 : values_[c];
    }
  }

  void append_counters(std::vector<Counter>& counters) const { policy_.append_counters(counters); }

 private:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  template <typename Changed>
  void set(std::size_t channel, double value, Changed& changed) {
    const double before = values_[channel];
    if (value != before && !(std::isnan(value) && std::isnan(before))) {
      values_[channel] = value;
      changed(channel, before);
    }
  }

  InputPolicy policy_;
  std::optional<double> initial_;
  std::vector<double> values_;
  bool begun_ = false;
  std::uint64_t revision_ = 0;
};

}  // namespace spikeloop
