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

#include "spikeloop/command/command_feed.hpp"
#include "spikeloop/command/operator_input.hpp"
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

struct CommandSettings {
  std::string node{};       ///< named in warnings; empty: its process is
  std::string driver{};     ///< the output that drives it, "decoder.out"; empty: not known
  std::uint32_t width = 0;  ///< fields of the command
  bool with_data_stamp = false;
  GateSettings gate;
  TimeNs watchdog = 0;  ///< wall time without a tick that stops the robot
  TimeNs max_age = 0;   ///< of the data; 0: any
  CommandClock clock = CommandClock::wall;
  std::vector<WatchedSensor> sensors{};  ///< as FeedSettings, and the next two
  std::vector<std::uint32_t> spike_widths{};
  TimeNs spike_timeout = 0;
  std::vector<std::string> fields{};  ///< for messages; the bounds run parallel to them
  std::vector<Bounds> bounds{};
  EmergencyStop emergency_stop{};
  Override manual{};
};

ChannelSettings channel_settings(const CommandSettings& settings);
FeedSettings feed_settings(const CommandSettings& settings);

/// Why a robot stands, as a sentence goes on behind "the robot is stopped: ".
std::string stop_cause(StopReason reason, const CommandSettings& settings, const CommandFeed& feed);
/// A warning of a value that the bounds have cut.
std::string cut_warning(const Limiter::Cut& cut, const CommandSettings& settings);

/// What a robot is doing, as diagnostic_msgs/DiagnosticStatus of ROS tells it.
struct Condition {
  enum class Level : std::uint8_t { ok, warning, error };
  Level level;
  std::string text;  ///< "the robot is stopped: ..."
};

/// Ports: as CommandFeed.
class CommandSink : public Sink {
 public:
  /// What carries the commands.
  struct Transport {
    CommandChannel::Publish publish;
    std::function<void()> finish;         ///< nothing more comes: waits until all is on its way
    std::function<void()> interrupted{};  ///< SIGINT: ends the process as SIGTERM would
    std::function<TimeNs(TimeNs now)> beat{};  ///< as Watch::Actions::beat
    std::function<void()> require{};           ///< throws in the loop when nothing leaves any more
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
  /// Before the loop begins; as CommandFeed.
  void on_latency(TakeLatency take) { feed_.on_latency(std::move(take)); }
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
  /// Zero, the last thing that leaves. Safe to call from any thread.
  void stop(StopReason reason);
  /// Safe to call from any thread.
  Condition condition() const;
  /// As CommandFeed's.
  nlohmann::json summary() const;
  /// At the end of a run: "the robot stood when the run ended: ...", when it does for want of data
  /// (a sensor is silent, or what is known is too old); empty otherwise.
  std::string missing_data() const;

 private:
  TimeNs now() const;
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
  bool ticked_ = false;               ///< the loop's
  std::mutex stopping_;
  bool stopped_ = false;
  Condition condition_of(const CommandChannel::Standing& standing) const;
  std::mutex announcing_;
  CommandChannel::Standing announced_;
  TimeNs announced_at_ = 0;
  bool cut_announced_ = false;
  CommandChannel channel_;
  CommandFeed feed_;
  OperatorInput operator_;
  std::optional<Watch> watch_;  ///< the last: it uses all the rest
};

}  // namespace spikeloop::command
