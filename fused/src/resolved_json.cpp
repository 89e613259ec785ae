// resolved.json: an experiment with every default, width and delay.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "spikeloop/core/files_read.hpp"
#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/fused/run.hpp"

namespace spikeloop::fused {
namespace {

using nlohmann::json;

/// Of a table, a list or a map.
std::string written_text(const experiment::Node& node, const std::string& name) {
  if (const auto written = node.written.find(name); written != node.written.end()) {
    return written->second.text;
  }
  if (node.node_class == nullptr) {
    return "";
  }
  const auto& declared = node.node_class->description.parameters;
  const auto parameter = std::ranges::find(declared, name, &ParameterDescription::name);
  return parameter == declared.end() ? "" : parameter->default_value.value_or("");
}

json connections_json(const experiment::Experiment& experiment) {
  json connections = json::array();
  for (const auto& connection : experiment.connections) {
    connections.push_back({{"from", connection.from},
                           {"to", connection.to},
                           {"width", connection.width},
                           {"delay_ticks", connection.delay_ticks.value_or(0)}});
    if (const ChannelRange& channels = connection.channels; !channels.all()) {
      const std::uint32_t end = channels.begin + channels.count(connection.width);
      connections.back()["channels"] = {channels.begin, end};
    }
    if (connection.combination != Combination::alone) {
      const bool adds = connection.combination == Combination::added;
      connections.back()["combination"] = adds ? "added" : "appended";
    }
  }
  return connections;
}

template <typename Value>
json or_null(const std::optional<Value>& value) {
  return value ? json(*value) : json(nullptr);
}

json robot_json(const experiment::Robot& robot) {
  if (!robot.bag.empty()) {
    return {{"bag", robot.bag}};
  }
  if (robot.model) {
    return {{"model", robot.model->file},
            {"keyframe", robot.model->keyframe},
            {"rate_hz", robot.model->rate_hz}};
  }
  if (const auto& environment = robot.environment) {
    json result{{"environment", environment->name},
                {"slippery", environment->slippery},
                {"seed", robot.seed}};
    result["step_ns"] = or_null(environment->step);
    return result;
  }
  return {{"world", robot.world}, {"seed", robot.seed}};
}

json episodes_json(const experiment::Episodes& episodes) {
  return {{"count", or_null(episodes.count)},
          {"time_limit_ns", or_null(episodes.time_limit)},
          {"hold_ns", episodes.hold},
          {"pause_ns", episodes.pause},
          {"reset", episodes.reset},
          {"pause_observation", or_null(episodes.pause_observation)},
          {"begin_reward", or_null(episodes.begin_reward)},
          {"end_reward", or_null(episodes.end_reward)},
          {"failure_reward", or_null(episodes.failure_reward)},
          {"collision_reward", or_null(episodes.collision_reward)},
          {"goal", episodes.goal}};
}

}  // namespace

json resolved_json(const experiment::Experiment& experiment) {
  json nodes = json::object();
  for (const auto& node : experiment.nodes) {
    json keys{{experiment::is_simulator(node) ? "simulator" : "node", node.kind}};
    for (const auto& [name, value] : node.parameters.all()) {
      if (const auto* number = std::get_if<double>(&value)) {
        keys[name] = *number;
      } else if (const auto* integer = std::get_if<std::int64_t>(&value)) {
        keys[name] = *integer;
      } else if (const auto* truth = std::get_if<bool>(&value)) {
        keys[name] = *truth;
      } else if (const auto* text = std::get_if<std::string>(&value)) {
        keys[name] = *text;
      } else {
        keys[name] = written_text(node, name);
      }
    }
    if (!node.record) {
      keys["record"] = false;
    }
    nodes[node.name] = keys;
  }
  json result{{"experiment", experiment.name},
              {"tick_ns", experiment.tick},
              {"seed", experiment.seed},
              {"sync", experiment::name_of(experiment.sync)},
              {"version", SPIKELOOP_VERSION},
              {"nodes", nodes},
              {"real_time_factor", experiment.real_time_factor},
              {kOnWriteFailureKey, to_text(experiment.on_write_failure)},
              {"ros", experiment::name_of(experiment.ros)},
              {"layout", name_of(experiment.layout)},
              {"connections", connections_json(experiment)},
              {"settings", json::parse(to_text(experiment.settings))}};
  result["duration_ns"] = or_null(experiment.duration);
  if (experiment.episodes) {
    result["episodes"] = episodes_json(*experiment.episodes);
  }
  if (experiment.robot) {
    result["robot"] = robot_json(*experiment.robot);
    if (const auto& camera = experiment.robot->camera) {
      result["robot"]["camera"] = {{"name", camera->name},
                                   {"width", camera->width},
                                   {"height", camera->height},
                                   {"rate_hz", camera->rate_hz},
                                   {"fov_deg", camera->field_of_view_deg}};
    }
  }
  result["experiment_file"] = experiment::file_of_user(experiment);
  result["files"] = json::object();
  for (const std::string& path : experiment.files) {
    result["files"][path] = file_print(path);
  }
  return result;
}

}  // namespace spikeloop::fused
