// The spikes of an interval, moment by moment: what decoders that look at each have in common.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// @throws std::runtime_error: a spike came on a channel that port 'in' of this width has not.
[[noreturn]] void refuse_channel(std::int32_t channel, std::uint32_t width);

/// Hands on the spikes that share a time together, in the order of time. Whoever advances from one
/// moment to the next, and not from tick to tick, gives the same result at every tick.
class SpikeMoments {
 public:
  /// Calls `at(time, spikes)`; late spikes come first, with their true time.
  /// @throws std::runtime_error when a channel is none of the port's.
  template <typename At>
  void take(const SpikeInput& input, const Interval& interval, At&& at) {
    for (std::span<const Spike> rest = input.spikes; !rest.empty();) {
      const TimeNs time = rest.front().time_ns;
      const auto other = std::find_if(rest.begin(), rest.end(),
                                      [time](const Spike& spike) { return spike.time_ns != time; });
      const auto now = rest.first(static_cast<std::size_t>(other - rest.begin()));
      for (const Spike& spike : now) {
        if (static_cast<std::uint32_t>(spike.channel) >= input.width) {
          refuse_channel(spike.channel, input.width);
        }
      }
      late_ += time <= interval.begin ? now.size() : 0;
      latest_ = std::max(latest_, time);
      at(time, now);
      rest = rest.subspan(now.size());
    }
    spikes_ += input.spikes.size();
  }

  /// The time of the latest spike so far: that of the present moment, unless it is a late one.
  TimeNs latest() const { return latest_; }
  /// spikes, late_spikes
  std::vector<Counter> counters() const { return {{"spikes", spikes_}, {"late_spikes", late_}}; }

 private:
  TimeNs latest_ = 0;
  std::uint64_t spikes_ = 0;
  std::uint64_t late_ = 0;
};

/// `tau` of decoders with an exponential kernel.
ParameterDescription kernel_tau_parameter();

}  // namespace spikeloop
