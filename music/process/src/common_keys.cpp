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
      number(
          "stoptime", "s", "none", 0,
          "simulated time at which the program ends; without it, it runs until stopped, in dialect "
          "ma for 1 s"),
      {.name = "music_timestep",
       .unit = "s",
       .default_value = "0.001",
       .minimum = 1e-9,
       .maximum = 1000,
       .text = "the tick, the same in all programs of a job"},
      boolean("barrier", true,
              "MPI_Barrier on all programs of the job, once before the first tick; true when all "
              "programs do so, false beside programs that do not"),
      {"seed",
       ParameterType::integer,
       "",
       "1",
       0,
       kInfinity,
       {},
       "seed of all random numbers, with the section's name"},
      choice("dialect", {"rma", "ma", "auto"},
             "whose defaults hold where older programs of these names differ; auto: those of the "
             "family that the job's programs belong to"),
      boolean("strict", false, "what is only warned of becomes an error"),
      boolean("pace", defaults.pace, "wait for the wall clock; true in one program of a job"),
      number("rtf", "1", "1.0", 1e-6, "real-time factor of the program that paces"),
      choice("sync", {"realtime", "unpaced"}, "what a program that paces waits for"),
      boolean("stamp_guard", true,
              "move outgoing spikes to at least 1 us after the begin of their tick, because NEST "
              "blocks a channel for ever after an earlier one"),
      number("accept_latency", "s", "0", 0,
             defaults.accept_one_tick
                 ? "acceptable latency of spike inputs; in dialect rma, unless written, one tick, "
                   "which is added to their times"
                 : "acceptable latency of spike inputs; a tick of it delays them by one tick"),
      {"signal_delay",
       ParameterType::integer,
       "",
       "0",
       0,
       1000,
       {},
       "whole ticks by which continuous inputs are delayed, beside the one that each hop costs; "
       "the "
       "delays and latencies around a closed loop must add up to a tick a hop"},
      {"spike_delay",
       ParameterType::integer,
       "",
       "0",
       0,
       1'000'000,
       {},
       "whole ticks by which spike inputs are delayed: their times grow by as much"},
      boolean("record", false, "record what this program puts out to $SPIKELOOP_OUT/LABEL.h5"),
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
  keys.pace = parameters.boolean("pace");
  keys.rtf = parameters.number("rtf");
  keys.unpaced = parameters.text("sync") == "unpaced";
  keys.stamp_guard = parameters.boolean("stamp_guard");
  set_latency(parameters, defaults, keys);
  keys.signal_delay = static_cast<int>(parameters.integer("signal_delay"));
  keys.spike_delay += parameters.integer("spike_delay") * keys.music_timestep;
  keys.record = parameters.boolean("record");
  return keys;
}

}  // namespace spikeloop::music
