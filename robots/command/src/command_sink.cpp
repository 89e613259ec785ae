#include "spikeloop/command/command_sink.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"

namespace spikeloop::command {
namespace {

/// Period of the checks for lost publishers and time-outs.
constexpr TimeNs kLook = 20'000'000;

std::vector<TimeNs> timeouts(const std::vector<WatchedSensor>& sensors) {
  std::vector<TimeNs> result(sensors.size());
  std::ranges::transform(sensors, result.begin(), &WatchedSensor::timeout);
  return result;
}

}  // namespace

CommandSink::CommandSink(const CommandSettings& settings, Transport& transport, bool watched)
    : settings_(settings),
      transport_(transport),
      channel_(settings,
               [this](std::span<const double> values) {
                 transport_.publish(values);
                 published_ = now();
               }),
      sensors_(timeouts(settings.sensors)),
      spikes_({settings.spike_timeout}),
      operator_(settings.emergency_stop, channel_) {
  if (watched) {
    watch_.emplace(settings.watchdog,
                   Watch::Actions{[this](StopReason reason) { stop_from_watch(reason); },
                                  [this](TimeNs now) { return channel_.poll(now); },
                                  [] { ::kill(::getpid(), SIGTERM); },
                                  [this](TimeNs wall) { return beat(wall); }});
  }
}

CommandSink::~CommandSink() {
  stop(StopReason::terminated);
}

std::vector<EndpointPort> CommandSink::ports() const {
  std::vector<EndpointPort> ports = {{"command", PortKind::signal, settings_.width()}};
  if (settings_.with_data_stamp) {
    ports.push_back({"data_stamp", PortKind::signal, 1});
  }
  for (std::size_t i = 0; i < settings_.sensors.size(); ++i) {
    ports.push_back({fmt::format("sensor_{}", i), PortKind::signal, 1});
  }
  for (std::size_t i = 0; i < settings_.spike_widths.size(); ++i) {
    ports.push_back({fmt::format("spikes_{}", i), PortKind::spikes, settings_.spike_widths[i]});
  }
  return ports;
}

void CommandSink::send(const Step& step) {
  if (!transport_.begin_tick(step.interval().end)) {
    alive();
    return;
  }
  simulated_ = step.interval().end;
  if (settings_.clock == CommandClock::lockstep) {
    operator_.apply(wall_now(), now());
  }
  const TimeNs now = this->now();
  settle_latencies(step.interval().end);  // for commands that were sent between ticks
  const std::optional<StopReason> reason = reason_to_stop(step, now);
  const TimeNs due =
      reason ? channel_.stop(*reason, now) : channel_.command(step.signal_input(0).values, now);
  ticked_ = true;
  if (settings_.clock != CommandClock::wall) {
    channel_.poll(now);
  }
  settle_latencies(step.interval().end);
  if (watch_) {
    watch_->heartbeat(settings_.clock == CommandClock::wall ? due : kNever);
  }
  announce();
  transport_.end_tick();
}

std::optional<StopReason> CommandSink::reason_to_stop(const Step& step, TimeNs now) {
  const std::optional<TimeNs> age = age_of_data(step, now);
  note_arrivals(step, now);
  // Before the first message, the output of encoders and offsets is not based on data.
  if (!step.signal_input(0).valid() || (settings_.with_data_stamp && !age)) {
    return StopReason::no_value;
  }
  if (const auto sensor = sensors_.silent(now)) {
    silent_sensor_ = *sensor;
    return StopReason::sensor_silent;
  }
  if (settings_.max_age != 0 && age && *age > settings_.max_age) {
    return StopReason::stale;
  }
  if (spikes_.silent(now)) {
    return StopReason::spikes_silent;
  }
  return std::nullopt;
}

std::optional<TimeNs> CommandSink::age_of_data(const Step& step, TimeNs now) {
  if (!settings_.with_data_stamp) {
    return std::nullopt;
  }
  const SignalInput data_stamp = step.signal_input(1);
  return age_.update(
      data_stamp.valid() ? data_stamp.values[0] : std::numeric_limits<double>::quiet_NaN(), now);
}

void CommandSink::on_latency(TakeLatency take) {
  if (take) {
    take_latency_.push_back(std::move(take));
  }
}

void CommandSink::settle_latencies(TimeNs simulated) {
  switch (channel_.network_command()) {
    case CommandChannel::NetworkCommand::held_back:
      break;
    case CommandChannel::NetworkCommand::unused:
      age_.drop();
      break;
    case CommandChannel::NetworkCommand::sent:
      age_.settle(published_, [&](TimeNs latency) {
        for (const TakeLatency& take : take_latency_) {
          take(simulated, static_cast<double>(latency) / 1e6);
        }
      });
  }
}

void CommandSink::note_arrivals(const Step& step, TimeNs now) {
  const std::size_t first = settings_.with_data_stamp ? 2 : 1;
  for (std::size_t i = 0; i < settings_.sensors.size(); ++i) {
    const SignalInput arrived = step.signal_input(first + i);
    if (arrived.valid() && std::isfinite(arrived.values[0])) {
      sensors_.set_arrival(i, from_seconds(arrived.values[0]));
    }
  }
  bool spikes = !ticked_;  // spike_timeout begins at the first tick
  for (std::size_t i = 0; i < settings_.spike_widths.size(); ++i) {
    spikes = spikes || !step.spike_input(i).spikes.empty();
  }
  if (spikes) {
    spikes_.set_arrival(0, now);
  }
}

void CommandSink::alive() {
  if (ticked_ && watch_) {
    watch_->heartbeat();
  }
}

TimeNs CommandSink::now() const {
  return settings_.clock == CommandClock::wall ? wall_now() : simulated_.load();
}

void CommandSink::stop_from_watch(StopReason reason) {
  if (settings_.clock == CommandClock::lockstep) {
    return;
  }
  channel_.stop(reason, now());
  announce();
}

void CommandSink::emergency(bool stop) {
  const TimeNs wall = wall_now();
  operator_.emergency(stop, wall);
  intervene(wall);
}

void CommandSink::press_stop(bool pressed) {
  operator_.press_stop(pressed);
  intervene(wall_now());
}

void CommandSink::override_with(std::span<const double> values) {
  operator_.override_with(values);
  intervene(wall_now());
}

void CommandSink::intervene(TimeNs wall) {
  if (settings_.clock != CommandClock::lockstep) {
    operator_.apply(wall, now());
    announce();
  }
}

TimeNs CommandSink::beat(TimeNs wall) {
  const TimeNs next = transport_.beat(wall);
  if (settings_.clock != CommandClock::lockstep) {
    operator_.set_lost_supervision(transport_.lost_supervision(wall));
  }
  intervene(wall);
  if (settings_.clock == CommandClock::wall) {
    // Repeat stop commands and end manual commands even without ticks.
    channel_.poll(now());
  } else if (settings_.clock == CommandClock::simulated && wall >= next_repetition_) {
    // No repetition becomes due while simulated time is paused.
    channel_.repeat_stop(now());
    next_repetition_ = wall + kLongestRepetition;
  }
  return std::min(next, wall + kLook);
}

/// "node 'wheels' at 1.2 s: "
std::string CommandSink::prefix() const {
  if (settings_.node.empty()) {
    return {};
  }
  return settings_.clock == CommandClock::wall
             ? fmt::format("node '{}': ", settings_.node)
             : fmt::format("node '{}' at {}: ", settings_.node, format_time(simulated_));
}

void CommandSink::announce() {
  // In lockstep, repeated runs print the same texts.
  const TimeNs now = settings_.clock == CommandClock::lockstep ? simulated_.load() : wall_now();
  const CommandChannel::Standing standing = channel_.standing();
  const auto cut = channel_.first_cut();
  const std::lock_guard lock(announcing_);
  if (cut && !cut_announced_) {
    cut_announced_ = true;
    log::warning("{}{}", prefix(), cut_warning(*cut, settings_));
  }
  const bool known =
      standing.stopped == announced_.stopped && standing.overridden == announced_.overridden;
  if (known || (announced_at_ != 0 && now - announced_at_ < kNsPerSecond)) {
    return;
  }
  const CommandChannel::Standing before = std::exchange(announced_, standing);
  announced_at_ = now;
  if (!standing.overridden && !standing.stopped) {
    log::warning("{}the robot is driven {}again", prefix(),
                 before.overridden ? "by the network " : "");
  } else if (standing.overridden || *standing.stopped < StopReason::terminated) {
    log::warning("{}{}", prefix(), condition_of(standing).text);
  }
}

Condition CommandSink::condition() const {
  return condition_of(channel_.standing());
}

Condition CommandSink::condition_of(const CommandChannel::Standing& standing) const {
  using enum Condition::Level;
  if (standing.overridden) {
    return {warning,
            fmt::format("manual commands on topic '{}' drive the robot", settings_.manual.topic)};
  }
  if (standing.stopped == StopReason::ended) {
    return {ok, "the run is over"};
  }
  if (standing.stopped) {
    return {error,
            "the robot is stopped: " + stop_cause(*standing.stopped, settings_, silent_sensor_)};
  }
  return standing.driven ? Condition{ok, "the robot is driven by the network"}
                         : Condition{warning, "there has been no command yet"};
}

void CommandSink::stop(StopReason reason) {
  // A second caller waits until the stop command is sent, because its process may end at once.
  const std::lock_guard lock(stopping_);
  if (stopped_) {
    return;
  }
  stopped_ = true;
  if (watch_) {
    watch_->rest();
  }
  channel_.stop(reason, now());
  transport_.finish();
}

std::vector<Counter> CommandSink::counters() const {
  return channel_.counters();
}

nlohmann::json CommandSink::summary() const {
  const auto measured = [](double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
  };
  const auto age = age_.report();
  return {{"commands", channel_.counters().front().value},
          {"stopped_s", to_seconds(channel_.stopped_time())},
          {"latency_median_ms", measured(age.latency_median_ms)},
          {"latency_p99_ms", measured(age.latency_p99_ms)},
          {"age_max_ms", measured(age.age_max_ms)},
          {"latency_clock", settings_.clock == CommandClock::wall ? "wall" : "simulated"}};
}

std::string CommandSink::missing_data() const {
  const auto reason = channel_.standing().stopped;
  const bool missing = reason == StopReason::sensor_silent || reason == StopReason::stale;
  return missing ? "the robot was stopped when the run ended: " +
                       stop_cause(*reason, settings_, silent_sensor_)
                 : "";
}

}  // namespace spikeloop::command
