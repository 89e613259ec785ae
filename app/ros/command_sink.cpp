#include "command_sink.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "spikeloop/core/pacer.hpp"

namespace spikeloop {

using command::StopReason;

CommandSink::CommandSink(const CommandSettings& settings, command::ComponentMap map,
                         Carrier carrier)
    : settings_(settings),
      map_(std::move(map)),
      carrier_(std::move(carrier)),
      channel_(settings.gate, carrier_.publish),
      watch_(settings.watchdog,
             {[this](StopReason reason) { channel_.stop(reason, wall_now()); },
              [this](TimeNs now) { return channel_.poll(now); }, carrier_.interrupted}) {}

CommandSink::~CommandSink() {
  stop(StopReason::terminated);
}

std::vector<EndpointPort> CommandSink::ports() const {
  std::vector<EndpointPort> ports = {{"in", PortKind::signal, settings_.width}};
  if (settings_.with_pace) {
    ports.push_back({"pace", PortKind::signal, 1});
  }
  return ports;
}

void CommandSink::send(const Step& step) {
  watch_.heartbeat(forward(step, wall_now()));
}

TimeNs CommandSink::forward(const Step& step, TimeNs now) {
  std::optional<TimeNs> age;
  if (settings_.with_pace) {
    const SignalInput pace = step.signal_input(1);
    age =
        age_.update(pace.valid() ? pace.values[0] : std::numeric_limits<double>::quiet_NaN(), now);
  }
  const SignalInput in = step.signal_input(0);
  if (!in.valid()) {
    return channel_.stop(StopReason::no_value, now);
  }
  if (settings_.max_age != 0 && age && *age > settings_.max_age) {
    return channel_.stop(StopReason::stale, now);
  }
  return channel_.command(map_.map(in.values), now);
}

void CommandSink::stop(StopReason reason) {
  if (stopped_.exchange(true)) {
    return;
  }
  watch_.rest();
  channel_.stop(reason, wall_now());
  carrier_.drain();
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
          {"latency_median_ms", measured(age.latency_median_ms)},
          {"latency_p99_ms", measured(age.latency_p99_ms)},
          {"age_max_ms", measured(age.age_max_ms)}};
}

}  // namespace spikeloop
