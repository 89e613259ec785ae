// What a tick brings to a command channel: a command, or a reason to stop.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "spikeloop/command/age_meter.hpp"
#include "spikeloop/command/command_channel.hpp"
#include "spikeloop/core/endpoint.hpp"

namespace spikeloop::command {

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
  /// Returns when the channel's poll() should be called if nothing else comes.
  TimeNs take(const Step& step, TimeNs now);
  /// commands, latency_median_ms, latency_p99_ms, age_max_ms; null where nothing was measured.
  nlohmann::json summary() const;

 private:
  Settings settings_;
  CommandChannel& channel_;
  AgeMeter age_;
};

}  // namespace spikeloop::command
