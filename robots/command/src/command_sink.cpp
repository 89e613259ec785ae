#include "spikeloop/command/command_sink.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"

namespace spikeloop::command {

namespace {

std::string cause(StopReason reason, const CommandSettings& settings) {
  switch (reason) {
    case StopReason::no_value:
      return "there is no value to send";
    case StopReason::not_finite:
      return "a command has a value that is no finite number";
    case StopReason::stale:
      return fmt::format("the data are older than max_age, {}", format_time(settings.max_age));
    case StopReason::silent:
      return fmt::format("no tick came for {}", format_time(settings.watchdog));
    case StopReason::continued:
      return "a program of the job has died, or this one had been stopped (SIGCONT)";
    case StopReason::terminated:
    case StopReason::ended:
      break;
  }
  return "the run is over";
}

}  // namespace

CommandSink::CommandSink(const CommandSettings& settings, Carrier carrier)
    : settings_(settings),
      carrier_(std::move(carrier)),
      channel_(settings.gate, carrier_.publish),
      feed_({settings.width, settings.with_pace, settings.max_age}, channel_),
      watch_(settings.watchdog, {[this](StopReason reason) { stop_from_watch(reason); },
                                 [this](TimeNs now) { return channel_.poll(now); },
                                 carrier_.interrupted, carrier_.beat}) {}

CommandSink::~CommandSink() {
  stop(StopReason::terminated);
}

std::vector<EndpointPort> CommandSink::ports() const {
  return feed_.ports();
}

void CommandSink::send(const Step& step) {
  if (carrier_.require) {
    carrier_.require();
  }
  ticked_ = true;
  simulated_ = step.interval().end;
  const TimeNs due = feed_.take(step, now());
  if (settings_.clock == CommandClock::wall) {
    watch_.heartbeat(due);
  } else {
    channel_.poll(now());
    watch_.heartbeat();
  }
  announce(wall_now());
}

void CommandSink::alive() {
  if (ticked_) {
    watch_.heartbeat();
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
  announce(wall_now());
}

void CommandSink::announce(TimeNs now) {
  const std::optional<StopReason> reason = channel_.stopped_by();
  const std::lock_guard lock(announcing_);
  if (reason == announced_ || (announced_at_ != 0 && now - announced_at_ < kNsPerSecond)) {
    return;
  }
  announced_ = reason;
  announced_at_ = now;
  if (!reason) {
    log::warning("the robot is driven again");
  } else if (*reason < StopReason::terminated) {
    log::warning("the robot is stopped: {}", cause(*reason, settings_));
  }
}

void CommandSink::stop(StopReason reason) {
  // Whoever comes second waits: its process may end at once, and the zero must be on its way.
  const std::lock_guard lock(stopping_);
  if (stopped_) {
    return;
  }
  stopped_ = true;
  watch_.rest();
  channel_.stop(reason, now());
  carrier_.finish();
}

std::vector<Counter> CommandSink::counters() const {
  return channel_.counters();
}

nlohmann::json CommandSink::summary() const {
  return feed_.summary();
}

}  // namespace spikeloop::command
