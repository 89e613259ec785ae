#include "recording_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/status/no_command.hpp"

namespace spikeloop::app {
namespace {

using experiment::Experiment;

constexpr TimeNs kLongest = 4 * kNsPerSecond;  // wall time

/// Names of the commands if only sensors are connected to them. Otherwise empty, because the other
/// nodes do not run.
std::set<std::string> commands_of_sensors(const Experiment& whole) {
  std::set<std::string> commands;
  for (const experiment::Node& node : whole.nodes) {
    if (node.kind == experiment::kRosCommand) {
      commands.insert(node.name);
    }
  }
  for (const experiment::Connection& connection : whole.connections) {
    if (commands.contains(experiment::node_of(connection.to)) &&
        !experiment::takes_messages(whole.node(experiment::node_of(connection.from)).kind)) {
      return {};
    }
  }
  return commands;
}

/// Experiment with the sensors and, if possible, the commands. Runs as fast as possible.
Experiment sensors_of(const Experiment& whole) {
  Experiment sensors = whole;
  std::set<std::string> names = commands_of_sensors(whole);
  for (const experiment::Node& node : whole.nodes) {
    if (experiment::takes_messages(node.kind)) {
      names.insert(node.name);
    }
  }
  std::erase_if(sensors.nodes,
                [&](const experiment::Node& node) { return !names.contains(node.name); });
  std::erase_if(sensors.connections, [&](const experiment::Connection& connection) {
    return !names.contains(experiment::node_of(connection.from)) ||
           !names.contains(experiment::node_of(connection.to));
  });
  sensors.episodes.reset();
  sensors.changes.clear();
  sensors.sync = experiment::Sync::unpaced;
  sensors.layout = {.processes = {{.name = "recording", .nodes = names}}};
  return sensors;
}

/// Sensors whose messages arrived and were all unusable, with a sentence about each.
std::map<std::string, std::string> useless_sensors(const Experiment& sensors,
                                                   const nlohmann::json& counters) {
  std::map<std::string, std::string> found;
  for (const experiment::Node& node : sensors.nodes) {
    nlohmann::json own = nlohmann::json::object();
    for (const auto& [key, value] : counters.items()) {
      if (experiment::takes_messages(node.kind) && key.substr(0, key.rfind('.')) == node.name) {
        own[key] = value;
      }
    }
    if (const auto no_command = status::find_no_command(own)) {
      found[node.name] = no_command->reason;
    }
  }
  return found;
}

/// True if a sensor that never has a value keeps the command from being sent.
bool is_stopped(const Experiment& whole, const experiment::Node& command,
                const std::map<std::string, std::string>& useless) {
  const auto sensors = experiment::sensors_behind(whole, command.name);
  const auto watched = experiment::watched_sensors(whole, command);  // in the order of `sensors`
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (watched[i].timeout > 0 && useless.contains(sensors[i]->name)) {
      return true;
    }
  }
  return false;
}

bool all_commands_are_stopped(const Experiment& whole,
                              const std::map<std::string, std::string>& useless) {
  const auto is_command = [](const experiment::Node& node) {
    return node.kind == experiment::kRosCommand;
  };
  return std::ranges::any_of(whole.nodes, is_command) &&
         std::ranges::all_of(whole.nodes, [&](const experiment::Node& node) {
           return !is_command(node) || is_stopped(whole, node, useless);
         });
}

void add_result(const Experiment& whole, const Experiment& sensors, const fused::RunResult& result,
                RecordingCheck& check) {
  const Location& where = whole.robot->where;
  const bool is_complete = check.checked >= whole.duration.value_or(0);
  const auto useless = useless_sensors(sensors, result.summary["counters"]);
  if (result.exit_code == UnusableMessages::kExitCode && !is_complete) {
    check.diagnostics.push_back(warning_at(where, result.reason));
  } else if (result.exit_code != 0) {
    check.diagnostics.push_back({{}, result.reason, result.exit_code});
  } else if (!useless.empty() && is_complete && all_commands_are_stopped(whole, useless)) {
    check.diagnostics.push_back(
        {{}, "no command was sent: " + useless.begin()->second, UnusableMessages::kExitCode});
  } else if (is_complete && !result.remark.empty()) {
    check.diagnostics.push_back(warning_at(where, result.remark));
  } else {
    for (const auto& [name, sentence] : useless) {
      check.diagnostics.push_back(warning_at(where, sentence));
    }
  }
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
    add_result(experiment, sensors, result, check);
  } catch (const Error& error) {
    check.diagnostics.push_back(diagnostic_of(error));
  }
  return check;
}

}  // namespace spikeloop::app
