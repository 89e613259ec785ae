#include "spikeloop/command/command_settings.hpp"

#include <algorithm>

#include "spikeloop/command/mapping.hpp"

namespace spikeloop::command {
namespace {

constexpr TimeNs kLeastInterval = 10'000'000;  // robot bases expect 10 to 100 Hz
constexpr TimeNs kLeastLockstepInterval = 1'000'000;
constexpr TimeNs kLongestJitter = 20'000'000;  // jitter of a sensor's driver
constexpr TimeNs kLeastWatchdog = 100'000'000;
constexpr TimeNs kYears = 1'000'000'000 * kNsPerSecond;

/// Adapts the settings to a loop whose ticks last `tick` of wall time.
void adapt_to_wall_clock(const Parameters& keys, TimeNs tick, CommandSettings& settings) {
  GateSettings& gate = settings.gate;
  if (!keys.given("min_interval")) {
    gate.min_interval = std::max(tick, kLeastInterval);
    gate.tolerance = tick / 2;
  }
  if (tick < gate.period) {
    gate.grace = std::min(gate.period / 4, kLongestJitter);
    // With fast ticks, the next tick sends a newer command instead of a repetition.
    gate.poll_grace = tick + tick / 2;
  }
  if (!keys.given("watchdog")) {
    settings.watchdog = std::max(3 * tick, kLeastWatchdog);
  }
}

}  // namespace

CommandSettings command_settings(const Parameters& keys, const CommandMapping& mapping,
                                 std::uint32_t width, const LoopClock& loop) {
  const double pace = loop.clock == CommandClock::wall ? loop.real_time_factor : 1;
  const auto in_clock = [&](double simulated_s) { return from_seconds(simulated_s / pace); };
  const double rate = keys.number("command_rate");
  CommandSettings settings{
      .message_type = mapping.message_type,
      .fields = field_paths(mapping),
      .gate = {.deadband = deadbands(components(mapping, width), keys.number("deadband")),
               .min_interval = from_seconds(keys.number("min_interval")),
               .period = rate > 0 ? in_clock(1 / rate) : 0},
      .watchdog = from_seconds(keys.number("watchdog")),
      .max_age = from_seconds(keys.number("max_age")),
      .clock = loop.clock,
      .bounds = bounds(mapping, width, keys.word("limits") != kNoLimits),
      .stops = stop_rules(mapping, width)};
  if (loop.clock == CommandClock::wall) {
    adapt_to_wall_clock(keys, in_clock(to_seconds(loop.tick)), settings);
  } else if (loop.clock == CommandClock::lockstep) {
    settings.watchdog = kYears;
    if (!keys.given("min_interval")) {
      settings.gate.min_interval = kLeastLockstepInterval;
    }
  }
  return settings;
}

}  // namespace spikeloop::command
