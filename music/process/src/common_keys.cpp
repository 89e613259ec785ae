#include "spikeloop/process/common_keys.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>

#include <limits>

namespace spikeloop::music {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

ParameterDescription boolean(const char* name, bool value, const char* text) {
  return {name, ParameterType::boolean, "", value ? "true" : "false", -kInfinity, kInfinity, {},
          text};
}

ParameterDescription number(const char* name, const char* unit, std::optional<std::string> value,
                            double minimum, const char* text) {
  return {name, ParameterType::number, unit, std::move(value), minimum, kInfinity, {}, text};
}

ParameterDescription choice(const char* name, std::vector<std::string> choices, const char* text) {
  return {name, ParameterType::choice, "", choices.front(), -kInfinity, kInfinity, choices, text};
}

Dialect dialect_of(const Parameters& parameters, const std::vector<std::string>& programs) {
  return located_at(parameters.where("dialect"),
                    [&] { return dialect_named(parameters.text("dialect"), programs); });
}

// Ways to keep time that experiment files know, but this version does not.
void check_sync(const WrittenValues& written) {
  const auto sync = written.find("sync");
  if (sync != written.end() &&
      (sync->second.text == "sim_time" || sync->second.text == "lockstep")) {
    throw ConfigurationError(
        sync->second.where,
        with_code(Code::unknown_choice,
                  "key 'sync': '{}' is not in this version; write realtime or unpaced",
                  sync->second.text));
  }
}

// The older program accepted a tick of latency and added it to the times of all spikes. Otherwise
// its sums would miss the newest ones, which come a tick late.
void set_latency(const Parameters& parameters, const CommonDefaults& defaults, CommonKeys& keys) {
  if (parameters.given("accept_latency")) {
    keys.accept_latency = from_seconds(parameters.number("accept_latency"));
  } else if (defaults.accept_one_tick && keys.dialect == Dialect::rma) {
    keys.accept_latency = keys.music_timestep;
    keys.spike_delay = keys.music_timestep;
  }
}

}  // namespace

std::vector<ParameterDescription> common_parameters(const CommonDefaults& defaults) {
  return {
      number("stoptime", "s", "none", 0,
             "Simulated time at which the program ends; not given: until stopped, or 1 s in "
             "dialect ma"),
      {.name = "music_timestep",
       .unit = "s",
       .default_value = "0.001",
       .minimum = 1e-9,
       .maximum = 1000,
       .text = "Tick; the same in all programs of a job"},
      boolean("barrier", true,
              "Call MPI_Barrier once before the first tick, on all programs of the job; false if "
              "a program does not call it"),
      {"seed",
       ParameterType::integer,
       "",
       "1",
       0,
       kInfinity,
       {},
       "Seed of all random numbers, combined with the label"},
      choice(
          "dialect", {"rma", "ma", "auto"},
          "Defaults of ros_music_adapter (rma) or music-adapters (ma); auto: those of the family "
          "of the job's programs"),
      boolean("strict", false, "Treat warnings as errors"),
      boolean("clock_master", defaults.clock_master,
              "Wait for the wall clock; true in one program of a job"),
      number("rtf", "1", "1.0", 1e-6, "Real-time factor; used if clock_master=true"),
      choice("sync", {"realtime", "unpaced"}, "Clock of the program with clock_master=true"),
      boolean("stamp_guard", true,
              "Move output spikes to at least 1 us after the start of their tick; NEST blocks a "
              "channel forever after an earlier spike"),
      number("accept_latency", "s", "0", 0,
             defaults.accept_one_tick
                 ? "Acceptable latency of spike inputs; default in dialect rma: one tick, "
                   "which is added to their times"
                 : "Acceptable latency of spike inputs; each whole tick delays them by a tick"),
      {"signal_delay",
       ParameterType::integer,
       "",
       "0",
       0,
       1000,
       {},
       "Delay of continuous inputs in whole ticks, in addition to one tick per hop; in a cycle, "
       "delays and latencies must add up to one tick per hop"},
      {"spike_delay",
       ParameterType::integer,
       "",
       "0",
       0,
       1'000'000,
       {},
       "Delay of spike inputs in whole ticks; it is added to their times"},
      boolean("record", false, "Record the outputs of this program in $SPIKELOOP_OUT/LABEL.h5"),
      choice(kOnWriteFailureKey, on_write_failure_choices(),
             "If the recording cannot be written: stop ends the job, continue prints a warning"),
  };
}

CommonKeys parse_common_keys(const WrittenValues& written, const CommonDefaults& defaults,
                             const std::vector<std::string>& programs) {
  check_sync(written);
  auto declared = common_parameters(defaults);
  if (!written.contains("stoptime")) {
    declared.erase(declared.begin());
  }
  const Parameters parameters = resolve(declared, written, {});
  CommonKeys keys;
  keys.dialect = dialect_of(parameters, programs);
  if (written.contains("stoptime")) {
    keys.stoptime = from_seconds(parameters.number("stoptime"));
  } else if (keys.dialect == Dialect::ma) {
    keys.stoptime = from_seconds(kStoptimeOfMa_s);
  }
  try {
    keys.music_timestep = tick_from_seconds(parameters.number("music_timestep"));
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(parameters.where("music_timestep"),
                             fmt::format("key 'music_timestep': {}", error.what()));
  }
  keys.barrier = parameters.boolean("barrier");
  keys.seed = static_cast<std::uint64_t>(parameters.integer("seed"));
  keys.strict = parameters.boolean("strict");
  keys.clock_master = parameters.boolean("clock_master");
  keys.rtf = parameters.number("rtf");
  keys.unpaced = parameters.text("sync") == "unpaced";
  keys.stamp_guard = parameters.boolean("stamp_guard");
  set_latency(parameters, defaults, keys);
  keys.signal_delay = static_cast<int>(parameters.integer("signal_delay"));
  keys.spike_delay += parameters.integer("spike_delay") * keys.music_timestep;
  keys.record = parameters.boolean("record");
  keys.on_write_failure = on_write_failure_of(parameters.text(kOnWriteFailureKey));
  return keys;
}

}  // namespace spikeloop::music
