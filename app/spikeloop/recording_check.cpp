#include "recording_check.hpp"

#include <fmt/format.h>

#include <set>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/fused/run.hpp"

namespace spikeloop::app {
namespace {

using experiment::Experiment;

constexpr TimeNs kLongest = 4 * kNsPerSecond;  // wall time

/// The sensors alone, as fast as possible.
Experiment sensors_of(const Experiment& whole) {
  Experiment sensors = whole;
  std::erase_if(sensors.nodes, [](const experiment::Node& node) {
    return !experiment::takes_messages(node.kind);
  });
  std::set<std::string> names;
  for (const experiment::Node& node : sensors.nodes) {
    names.insert(node.name);
  }
  sensors.connections.clear();
  sensors.episodes.reset();
  sensors.changes.clear();
  sensors.sync = experiment::Sync::unpaced;
  sensors.layout = {.processes = {{.name = "recording", .nodes = names}}};
  return sensors;
}

}  // namespace

RecordingCheck check_recording(const Experiment& experiment) {
  RecordingCheck check;
  const Location& where = experiment.robot->where;
  const Experiment sensors = sensors_of(experiment);
  const TimeNs began = wall_now();
  const log::Listener listener([&](log::Level level, std::string_view message) {
    if (level == log::Level::warning) {
      const std::string when =
          check.checked > 0 ? fmt::format("at {}: ", format_time(check.checked)) : "";
      check.diagnostics.push_back(warning_at(where, when + std::string(message)));
    }
  });
  try {
    const fused::RunResult result =
        fused::run(sensors, {.record = false},
                   {.ticked = [&](TimeNs time) { check.checked = time; },
                    .stop = [&] { return wall_now() - began > kLongest; }});
    if (result.exit_code != 0) {
      check.diagnostics.push_back({{}, result.reason, result.exit_code});
    }
  } catch (const Error& error) {
    check.diagnostics.push_back(diagnostic_of(error));
  }
  return check;
}

}  // namespace spikeloop::app
