// What a tick brings to a command channel: a command, or a reason to stop.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "spikeloop/command/age_meter.hpp"
#include "spikeloop/command/command_channel.hpp"
#include "spikeloop/command/silence_watch.hpp"
#include "spikeloop/core/endpoint.hpp"

namespace spikeloop::command {

/// Called in the loop when the first command leaves that a message has reached: simulated time, and
/// how long ago the message came.
using TakeLatency = std::function<void(TimeNs simulated, TimeNs latency)>;

/// A sensor that a command depends on.
struct WatchedSensor {
  std::string topic;
  TimeNs timeout = 0;  ///< without a message that has a reading; 0: any
};

/// What of a command's past is watched.
struct FeedSettings {
  std::uint32_t width = 0;  ///< fields of the command
  bool with_data_stamp = false;
  bool simulated = false;  ///< times, and so ages, are simulated ones; else those of the wall clock
  TimeNs max_age = 0;      ///< of the data; 0: any
  std::vector<WatchedSensor> sensors{};
  std::vector<std::uint32_t> spike_widths{};  ///< of the spikes on the way, a port each
  TimeNs spike_timeout = 0;                   ///< without one of them; 0: any
};

/// The end of a loop, whatever clock it goes by: the ports `command` [width], `with_data_stamp`
/// `data_stamp` [1], `sensor_0` [1], ...: the times at which the newest messages arrived, in s; and
/// the spikes `spikes_0` [width], ...
class CommandFeed {
 public:
  CommandFeed(const FeedSettings& settings, CommandChannel& channel);

  std::vector<EndpointPort> ports() const;
  /// Before the loop begins. Nothing is called without `with_data_stamp`.
  void on_latency(TakeLatency take) { take_latency_ = std::move(take); }
  /// Returns when the channel's poll() should be called if nothing else comes.
  TimeNs take(const Step& step, TimeNs now);
  /// commands, latency_median_ms, latency_p99_ms, age_max_ms; null where nothing was measured.
  /// latency_clock: wall or simulated, the time that these are of. stopped_s: the channel's
  /// stood_for().
  nlohmann::json summary() const;
  /// The sensor that was silent when one last was. Safe to call from any thread.
  const WatchedSensor& silent_sensor() const;

 private:
  /// Nothing without data, or before their first message.
  std::optional<TimeNs> age_of_data(const Step& step, TimeNs now);
  void hear(const Step& step, TimeNs now);

  FeedSettings settings_;
  CommandChannel& channel_;
  AgeMeter age_;
  SilenceWatch sensors_;
  SilenceWatch spikes_;
  bool began_ = false;
  std::atomic<std::size_t> silent_sensor_{0};
  TakeLatency take_latency_;
};

}  // namespace spikeloop::command
