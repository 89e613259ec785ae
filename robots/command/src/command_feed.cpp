#include "spikeloop/command/command_feed.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

namespace spikeloop::command {

std::vector<EndpointPort> CommandFeed::ports() const {
  std::vector<EndpointPort> ports = {{"command", PortKind::signal, settings_.width}};
  if (settings_.with_pace) {
    ports.push_back({"pace", PortKind::signal, 1});
  }
  return ports;
}

TimeNs CommandFeed::take(const Step& step, TimeNs now) {
  std::optional<TimeNs> age;
  if (settings_.with_pace) {
    const SignalInput pace = step.signal_input(1);
    const std::uint64_t known = age_.messages();
    age =
        age_.update(pace.valid() ? pace.values[0] : std::numeric_limits<double>::quiet_NaN(), now);
    if (take_latency_ && age && age_.messages() != known) {
      take_latency_(step.interval().end, *age);
    }
  }
  const SignalInput in = step.signal_input(0);
  // Without a message there is nothing to drive on, whatever an encoder and an offset make of it.
  if (!in.valid() || (settings_.with_pace && !age)) {
    return channel_.stop(StopReason::no_value, now);
  }
  if (settings_.max_age != 0 && age && *age > settings_.max_age) {
    return channel_.stop(StopReason::stale, now);
  }
  return channel_.command(in.values, now);
}

nlohmann::json CommandFeed::summary() const {
  const auto measured = [](double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
  };
  const auto age = age_.report();
  return {{"commands", channel_.counters().front().value},
          {"latency_median_ms", measured(age.latency_median_ms)},
          {"latency_p99_ms", measured(age.latency_p99_ms)},
          {"age_max_ms", measured(age.age_max_ms)}};
}

}  // namespace spikeloop::command
