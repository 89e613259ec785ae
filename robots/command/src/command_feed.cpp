#include "spikeloop/command/command_feed.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

namespace spikeloop::command {
namespace {

std::vector<TimeNs> timeouts(const std::vector<WatchedSensor>& sensors) {
  std::vector<TimeNs> result;
  result.reserve(sensors.size());
  for (const WatchedSensor& sensor : sensors) {
    result.push_back(sensor.timeout);
  }
  return result;
}

}  // namespace

CommandFeed::CommandFeed(const FeedSettings& settings, CommandChannel& channel)
    : settings_(settings),
      channel_(channel),
      sensors_(timeouts(settings.sensors)),
      spikes_({settings.spike_timeout}) {}

std::vector<EndpointPort> CommandFeed::ports() const {
  std::vector<EndpointPort> ports = {{"command", PortKind::signal, settings_.width}};
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

std::optional<TimeNs> CommandFeed::age_of_data(const Step& step, TimeNs now) {
  if (!settings_.with_data_stamp) {
    return std::nullopt;
  }
  const SignalInput data_stamp = step.signal_input(1);
  const std::uint64_t known = age_.messages();
  const std::optional<TimeNs> age = age_.update(
      data_stamp.valid() ? data_stamp.values[0] : std::numeric_limits<double>::quiet_NaN(), now);
  if (take_latency_ && age && age_.messages() != known) {
    take_latency_(step.interval().end, *age);
  }
  return age;
}

void CommandFeed::hear(const Step& step, TimeNs now) {
  const std::size_t first = settings_.with_data_stamp ? 2 : 1;
  for (std::size_t i = 0; i < settings_.sensors.size(); ++i) {
    const SignalInput arrived = step.signal_input(first + i);
    if (arrived.valid() && std::isfinite(arrived.values[0])) {
      sensors_.heard(i, from_seconds(arrived.values[0]));
    }
  }
  bool spikes = !began_;  // a network gets its time from the first tick on
  for (std::size_t i = 0; i < settings_.spike_widths.size(); ++i) {
    spikes = spikes || !step.spike_input(i).spikes.empty();
  }
  if (spikes) {
    spikes_.heard(0, now);
  }
  began_ = true;
}

TimeNs CommandFeed::take(const Step& step, TimeNs now) {
  const std::optional<TimeNs> age = age_of_data(step, now);
  hear(step, now);
  const SignalInput in = step.signal_input(0);
  // Without a message there is nothing to drive on, whatever an encoder and an offset make of it.
  if (!in.valid() || (settings_.with_data_stamp && !age)) {
    return channel_.stop(StopReason::no_value, now);
  }
  if (const auto sensor = sensors_.silent(now)) {
    silent_sensor_ = *sensor;
    return channel_.stop(StopReason::sensor_silent, now);
  }
  if (settings_.max_age != 0 && age && *age > settings_.max_age) {
    return channel_.stop(StopReason::stale, now);
  }
  if (spikes_.silent(now)) {
    return channel_.stop(StopReason::spikes_silent, now);
  }
  return channel_.command(in.values, now);
}

nlohmann::json CommandFeed::summary() const {
  const auto measured = [](double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
  };
  const auto age = age_.report();
  return {{"commands", channel_.counters().front().value},
          {"stopped_s", to_seconds(channel_.stood_for())},
          {"latency_median_ms", measured(age.latency_median_ms)},
          {"latency_p99_ms", measured(age.latency_p99_ms)},
          {"age_max_ms", measured(age.age_max_ms)},
          {"latency_clock", settings_.simulated ? "simulated" : "wall"}};
}

const WatchedSensor& CommandFeed::silent_sensor() const {
  return settings_.sensors[silent_sensor_];
}

}  // namespace spikeloop::command
