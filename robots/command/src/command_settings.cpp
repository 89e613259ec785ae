#include "spikeloop/command/command_settings.hpp"

#include <algorithm>

namespace spikeloop::command {
namespace {

constexpr TimeNs kLeastInterval = 10'000'000;  // robot bases expect 10 to 100 Hz
constexpr TimeNs kLeastLockstepInterval = 1'000'000;
constexpr TimeNs kLongestJitter = 20'000'000;  // of a sensor's driver
constexpr TimeNs kLeastWatchdog = 100'000'000;
constexpr TimeNs kYears = 1'000'000'000 * kNsPerSecond;

}  // namespace

CommandSettings command_settings(const Parameters& keys, const ComponentMap& map,
                                 double command_rate, const LoopClock& clock,
                                 bool with_data_stamp) {
  const auto wall = [&](double simulated_s) {
    return from_seconds(simulated_s / clock.real_time_factor);
  };
  const TimeNs tick = wall(to_seconds(clock.tick));
  CommandSettings settings;
  settings.gate.deadband = map.deadbands(keys.number("deadband"));
  if (keys.given("min_interval")) {
    settings.gate.min_interval = from_seconds(keys.number("min_interval"));
  } else {
    settings.gate.min_interval = std::max(tick, kLeastInterval);
    settings.gate.tolerance = tick / 2;
  }
  settings.gate.period = command_rate > 0 ? wall(1 / command_rate) : 0;
  if (tick < settings.gate.period) {
    settings.gate.grace = std::min(settings.gate.period / 4, kLongestJitter);
    // Fast ticks repeat commands themselves, with newer values.
    settings.gate.poll_grace = tick + tick / 2;
  }
  settings.watchdog = keys.given("watchdog") ? from_seconds(keys.number("watchdog"))
                                             : std::max(3 * tick, kLeastWatchdog);
  settings.max_age = from_seconds(keys.number("max_age"));
  settings.width = static_cast<std::uint32_t>(map.size());
  settings.with_data_stamp = with_data_stamp;
  settings.bounds = map.bounds();
  return settings;
}

CommandSettings simulated_settings(const Parameters& keys, const ComponentMap& map,
                                   CommandClock clock, bool with_data_stamp) {
  const double rate = keys.number("command_rate");
  const bool every_step = clock == CommandClock::lockstep && !keys.given("min_interval");
  CommandSettings settings;
  settings.gate = {.deadband = map.deadbands(keys.number("deadband")),
                   .min_interval = every_step ? kLeastLockstepInterval
                                              : from_seconds(keys.number("min_interval")),
                   .period = rate > 0 ? from_seconds(1 / rate) : 0};
  settings.watchdog =
      clock == CommandClock::lockstep ? kYears : from_seconds(keys.number("watchdog"));
  settings.max_age = from_seconds(keys.number("max_age"));
  settings.width = static_cast<std::uint32_t>(map.size());
  settings.with_data_stamp = with_data_stamp;
  settings.clock = clock;
  settings.bounds = map.bounds();
  return settings;
}

}  // namespace spikeloop::command
