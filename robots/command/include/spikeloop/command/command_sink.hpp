// Sink of a loop: sends channels as commands, and stops the robot when the loop ends or fails.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/command/age_meter.hpp"
#include "spikeloop/command/command_channel.hpp"
#include "spikeloop/command/operator_input.hpp"
#include "spikeloop/command/silence_watch.hpp"
#include "spikeloop/command/watch.hpp"
#include "spikeloop/core/endpoint.hpp"

namespace spikeloop::command {

/// Called in the loop after the first command that is computed from a message has been sent:
/// simulated time, and the time from the arrival of the message to the sending of the command.
using TakeLatency = std::function<void(TimeNs simulated, double latency_ms)>;

/// Cause of a stop as a text that follows "the robot is stopped: ".
/// @param silent_sensor index in settings.sensors, used for `sensor_silent` only
std::string stop_cause(StopReason reason, const CommandSettings& settings,
                       std::size_t silent_sensor);
/// Warning about a value beyond a minimum or maximum.
std::string cut_warning(const Limiter::Cut& cut, const CommandSettings& settings);

/// Condition of a robot, as in diagnostic_msgs/DiagnosticStatus of ROS.
struct Condition {
  enum class Level : std::uint8_t { ok, warning, error };
  Level level;
  std::string text;  ///< "the robot is stopped: ..."
};

/// Ports: `command` [width]; `data_stamp` [1] if `with_data_stamp`; `sensor_0` [1], ...: times at
/// which the newest messages arrived, in s; `spikes_0` [width], ...: spikes on the path to the
/// command.
class CommandSink : public Sink {
 public:
  /// Publishes the commands.
  class Transport {
   public:
    virtual ~Transport() = default;
    virtual void publish(std::span<const double> values) = 0;
    /// Called after the last message. Waits until all messages have been sent.
    virtual void finish() {}
    /// Called in the loop before a tick that ends at `end` sends its command. Returns false if
    /// nothing may be sent yet. @throws if nothing can be sent any more.
    virtual bool begin_tick(TimeNs /*end*/) { return true; }
    /// Called in the loop after the command of a tick.
    virtual void end_tick() {}
    /// As Watch::Actions::beat.
    virtual TimeNs beat(TimeNs /*now*/) { return kNever; }
    /// Called after beat(), but not in lockstep, where no run depends on wall time. Returns a
    /// reason to stop while the robot is not supervised or guarded.
    virtual std::optional<StopReason> lost_supervision(TimeNs /*now*/) { return std::nullopt; }
  };

  /// @param watched a thread stops the robot when the loop hangs or the process is to end; SIGINT
  /// ends the process as SIGTERM does. False leaves the signals to the process.
  CommandSink(const CommandSettings& settings, Transport& transport, bool watched = true);
  /// Stops the robot, also after an error.
  ~CommandSink() override;

  std::vector<EndpointPort> ports() const override;
  void send(const Step& step) override;
  std::vector<Counter> counters() const override;

  /// Called while the loop waits. The waiting time does not count as silence; before the first tick
  /// there is no time-out.
  void alive();
  /// Adds a receiver of latencies. Does nothing if `take` is empty. Call before the loop begins.
  /// Without `with_data_stamp` no latency is measured.
  void on_latency(TakeLatency take);
  // Functions of OperatorInput. Input takes effect at once, in lockstep at the next tick.
  // Thread-safe.
  void watch_publishers(std::function<bool()> has_publishers) {
    operator_.watch_publishers(std::move(has_publishers));
  }
  void emergency(bool stop);
  void press_stop(bool pressed);
  void override_with(std::span<const double> values);

  // Functions of CommandChannel. Thread-safe.
  void measure(std::span<const double> positions) { channel_.measure(positions, now()); }
  std::vector<double> stop_values() const { return channel_.stop_values(now()); }
  bool drives() const { return channel_.drives(); }
  void restart_commands() { channel_.restart_commands(now()); }
  void allow_no_value() { channel_.allow_no_value(); }
  /// Sends the stop command as the last message.
  void stop(StopReason reason);
  Condition condition() const;
  /// Keys: commands, latency_median_ms, latency_p99_ms, age_max_ms; null if nothing was measured.
  /// latency_clock: wall or simulated. stopped_s: CommandChannel::stopped_time().
  nlohmann::json summary() const;
  /// Text for the end of a run: "the robot was stopped when the run ended: ...", if the reason is a
  /// lack of data (a silent sensor, or data older than max_age); empty otherwise.
  std::string missing_data() const;

 private:
  TimeNs now() const;
  /// Reason to stop in the data of a tick; nullopt if there is none.
  std::optional<StopReason> reason_to_stop(const Step& step, TimeNs now);
  /// Age of the data behind a command. nullopt without data, or before their first message.
  std::optional<TimeNs> age_of_data(const Step& step, TimeNs now);
  void note_arrivals(const Step& step, TimeNs now);
  void settle_latencies(TimeNs simulated);
  void stop_from_watch(StopReason reason);
  TimeNs beat(TimeNs wall);
  void intervene(TimeNs wall);
  /// Warns when the robot is stopped or driven again, at most once a second.
  void announce();
  std::string prefix() const;

  CommandSettings settings_;
  Transport& transport_;
  std::atomic<TimeNs> simulated_{0};  ///< end of the newest tick
  std::atomic<TimeNs> published_{0};  ///< time after the newest message was sent
  bool ticked_ = false;               ///< used by the loop only
  TimeNs next_repetition_ = 0;  ///< wall time of the next stop command; used by the watch only
  std::mutex stopping_;
  bool stopped_ = false;
  Condition condition_of(const CommandChannel::Standing& standing) const;
  std::mutex announcing_;
  CommandChannel::Standing announced_;
  TimeNs announced_at_ = 0;
  bool cut_announced_ = false;
  CommandChannel channel_;
  AgeMeter age_;
  SilenceWatch sensors_;
  SilenceWatch spikes_;
  std::atomic<std::size_t> silent_sensor_{0};  ///< index of the newest silent sensor
  std::vector<TakeLatency> take_latency_;
  OperatorInput operator_;
  std::optional<Watch> watch_;  ///< last member: its thread uses all others
};

}  // namespace spikeloop::command
