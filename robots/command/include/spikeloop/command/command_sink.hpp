// The end of a loop: channels in, commands out, a zero whatever happens.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "spikeloop/command/age_meter.hpp"
#include "spikeloop/command/command_channel.hpp"
#include "spikeloop/command/operator_input.hpp"
#include "spikeloop/command/silence_watch.hpp"
#include "spikeloop/command/watch.hpp"
#include "spikeloop/core/endpoint.hpp"

namespace spikeloop::command {

/// Whose time gates and ages go by.
enum class CommandClock : std::uint8_t {
  wall,
  simulated,  ///< commands leave in ticks only; the watchdog stays wall time
  /// The same, and the robot does not move between ticks: neither silence nor SIGCONT stops it, and
  /// what people say counts from the next tick on.
  lockstep
};

/// Called in the loop after the first command that is computed from a message has been sent:
/// simulated time, and the time from the arrival of the message to the sending of the command.
using TakeLatency = std::function<void(TimeNs simulated, TimeNs latency)>;

/// A sensor that a command depends on.
struct WatchedSensor {
  std::string topic;
  TimeNs timeout = 0;  ///< without a message that has a reading; 0: any
};

struct CommandSettings {
  std::string node{};       ///< named in warnings; empty: its process is
  std::string driver{};     ///< the output that drives it, "decoder.out"; empty: not known
  std::uint32_t width = 0;  ///< fields of the command
  bool with_data_stamp = false;
  GateSettings gate;
  TimeNs watchdog = 0;  ///< wall time without a tick that stops the robot
  TimeNs max_age = 0;   ///< of the data; 0: any
  CommandClock clock = CommandClock::wall;
  std::vector<WatchedSensor> sensors{};
  std::vector<std::uint32_t> spike_widths{};  ///< of the spikes on the way, a port each
  TimeNs spike_timeout = 0;                   ///< without one of them; 0: any
  std::vector<std::string> fields{};          ///< for messages; the bounds run parallel to them
  std::vector<Bounds> bounds{};
  EmergencyStop emergency_stop{};
  Override manual{};
  std::vector<StopRule> stops{};  ///< as ChannelSettings has them
  std::string joint_states{};     ///< topic of the positions that a stop holds; empty: none
  bool guard_required = false;    ///< the robot is stopped while no guard answers
};

/// Why a robot stands, as a sentence goes on behind "the robot is stopped: ".
/// @param silent_sensor of settings.sensors, for that reason
std::string stop_cause(StopReason reason, const CommandSettings& settings,
                       std::size_t silent_sensor);
/// A warning of a value that the bounds have cut.
std::string cut_warning(const Limiter::Cut& cut, const CommandSettings& settings);

/// What a robot is doing, as diagnostic_msgs/DiagnosticStatus of ROS tells it.
struct Condition {
  enum class Level : std::uint8_t { ok, warning, error };
  Level level;
  std::string text;  ///< "the robot is stopped: ..."
};

/// Ports: `command` [width]; `with_data_stamp` `data_stamp` [1], `sensor_0` [1], ...: the times at
/// which the newest messages arrived, in s; and the spikes `spikes_0` [width], ...
class CommandSink : public Sink {
 public:
  /// What carries the commands.
  struct Transport {
    CommandChannel::Publish publish;
    std::function<void()> finish;         ///< nothing more comes: waits until all is on its way
    std::function<void()> interrupted{};  ///< SIGINT: ends the process as SIGTERM would
    std::function<TimeNs(TimeNs now)> beat{};  ///< as Watch::Actions::beat
    /// After `beat`: reason to stop while nobody supervises or guards the robot. Not called in
    /// lockstep, where no run depends on wall time.
    std::function<std::optional<StopReason>(TimeNs now)> lost_supervision{};
    /// In the loop, before and after what a tick sends; `end` is its end. The first one throws when
    /// nothing leaves any more; false: nothing may leave yet, and the tick is let pass.
    std::function<bool(TimeNs end)> begin_tick{};
    std::function<void()> end_tick{};
    /// A thread stops the robot when the loop hangs or the process is told to end. Without it the
    /// process's signals stay its own.
    bool watched = true;
  };

  CommandSink(const CommandSettings& settings, Transport transport);
  /// An error on the way ends here: zero.
  ~CommandSink() override;

  std::vector<EndpointPort> ports() const override;
  void send(const Step& step) override;
  std::vector<Counter> counters() const override;

  /// The loop lives, but waits: its silence does not count. Before the first tick nothing does.
  void alive();
  /// As CommandChannel's.
  void begin_anew() { channel_.begin_anew(now()); }
  /// As CommandChannel's.
  void allow_no_value() { channel_.allow_no_value(); }
  /// Before the loop begins. Nothing is called without `with_data_stamp`.
  void on_latency(TakeLatency take) { take_latency_ = std::move(take); }
  /// As OperatorInput.
  void watch_publishers(std::function<bool()> has_publishers) {
    operator_.watch_publishers(std::move(has_publishers));
  }
  /// The emergency stop is pressed, or released. Safe to call from any thread.
  void emergency(bool stop);
  /// STOP of the live view is pressed, or released. Safe to call from any thread.
  void press_stop(bool pressed);
  /// A command by hand. Safe to call from any thread.
  void override_with(std::span<const double> values);
  /// As CommandChannel. Safe to call from any thread.
  void measure(std::span<const double> positions) { channel_.measure(positions, now()); }
  std::vector<double> stop_values() const { return channel_.stop_values(now()); }
  bool drives() const { return channel_.drives(); }
  /// Zero, the last thing that leaves. Safe to call from any thread.
  void stop(StopReason reason);
  /// Safe to call from any thread.
  Condition condition() const;
  /// commands, latency_median_ms, latency_p99_ms, age_max_ms; null where nothing was measured.
  /// latency_clock: wall or simulated, the time that these are of. stopped_s: the channel's
  /// stood_for().
  nlohmann::json summary() const;
  /// At the end of a run: "the robot was stopped when the run ended: ...", when it is for want of
  /// data (a sensor is silent, or what is known is too old); empty otherwise.
  std::string missing_data() const;

 private:
  TimeNs now() const;
  /// What of a tick's data forbids its command.
  std::optional<StopReason> reason_to_stop(const Step& step, TimeNs now);
  /// Nothing without data, or before their first message.
  std::optional<TimeNs> age_of_data(const Step& step, TimeNs now);
  void note_arrivals(const Step& step, TimeNs now);
  /// Measures latencies of messages whose command has been sent.
  void settle_latencies(TimeNs simulated);
  /// The watch's reasons.
  void stop_from_watch(StopReason reason);
  TimeNs beat(TimeNs wall);
  void intervene(TimeNs wall);
  /// Warns when the robot is stopped or driven again, at most once a second.
  void announce();
  std::string prefix() const;

  CommandSettings settings_;
  Transport transport_;
  std::atomic<TimeNs> simulated_{0};  ///< end of the newest tick
  std::atomic<TimeNs> published_{0};  ///< time after the newest message was sent
  bool ticked_ = false;               ///< the loop's
  TimeNs next_repetition_ = 0;        ///< wall time of the next zero; used by the watch only
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
  std::atomic<std::size_t> silent_sensor_{0};  ///< when one last was
  TakeLatency take_latency_;
  OperatorInput operator_;
  std::optional<Watch> watch_;  ///< the last: it uses all the rest
};

}  // namespace spikeloop::command
