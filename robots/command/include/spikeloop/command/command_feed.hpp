// What a tick brings to a command channel: a command, or a reason to stop.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <utility>
#include <vector>

#include "spikeloop/command/age_meter.hpp"
#include "spikeloop/command/command_channel.hpp"
#include "spikeloop/core/endpoint.hpp"

namespace spikeloop::command {

/// Called in the loop when the first command leaves that a message has reached: simulated time, and
/// how long ago the message came.
using TakeLatency = std::function<void(TimeNs simulated, TimeNs latency)>;

/// The end of a loop, whatever clock it goes by: the ports `command` [width] and, `with_pace`,
/// `pace` [1].
class CommandFeed {
 public:
  struct Settings {
    std::uint32_t width = 0;  ///< fields of the command
    bool with_pace = false;
    TimeNs max_age = 0;  ///< of the data; 0: any
  };

  CommandFeed(const Settings& settings, CommandChannel& channel)
      : settings_(settings), channel_(channel) {}

  std::vector<EndpointPort> ports() const;
  /// Before the loop begins. Nothing is called without `with_pace`.
  void on_latency(TakeLatency take) { take_latency_ = std::move(take); }
  /// Returns when the channel's poll() should be called if nothing else comes.
  TimeNs take(const Step& step, TimeNs now);
  /// commands, latency_median_ms, latency_p99_ms, age_max_ms; null where nothing was measured.
  nlohmann::json summary() const;

 private:
  Settings settings_;
  CommandChannel& channel_;
  AgeMeter age_;
  TakeLatency take_latency_;
};

}  // namespace spikeloop::command
