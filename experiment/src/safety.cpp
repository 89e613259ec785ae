#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "faults.hpp"
#include "spikeloop/config/message_type.hpp"
#include "spikeloop/messages/field_path.hpp"

namespace spikeloop::experiment {
namespace {

using Parameter = ParameterDescription;

constexpr const char* kNone = "none";

Parameter text(const char* name, const char* value, const char* line) {
  return {.name = name, .type = ParameterType::text, .default_value = value, .text = line};
}
Parameter boolean(const char* name, const char* line) {
  return {.name = name, .type = ParameterType::boolean, .default_value = "false", .text = line};
}

std::string topic_of(const Node& node, const char* key, const Parameters& keys,
                     const std::string& otherwise) {
  const std::string& written = keys.text("topic");
  if (written == kNone) {
    return "";
  }
  const std::string& topic = written.empty() ? otherwise : written;
  if (topic == node.parameters.text("topic")) {
    throw ConfigurationError(
        node.parameters.where(key),
        with_code(
            Code::topic_conflict,
            "key '{}': {} is the topic of the commands themselves; write another one, or none", key,
            topic));
  }
  return topic;
}

/// Of an event camera silence says nothing, unless the experiment says that it does.
bool is_watched(const Node& node) {
  return node.kind == kRosSensor ||
         (node.kind == kRosEventSensor && node.parameters.number("timeout") > 0);
}

/// Everything that a node depends on, itself included, as long as `follow` wants to go on.
template <typename Follow>
std::set<std::string> behind(const Experiment& experiment, const std::string& node,
                             Follow&& follow) {
  std::set<std::string> seen{node};
  std::vector<std::string> open{node};
  while (!open.empty()) {
    const std::string current = open.back();
    open.pop_back();
    for (const Connection& connection : experiment.connections) {
      if (node_of(connection.to) == current && follow(connection) &&
          seen.insert(node_of(connection.from)).second) {
        open.push_back(node_of(connection.from));
      }
    }
  }
  return seen;
}

}  // namespace

Parameter emergency_stop_parameter() {
  return {
      .name = "emergency_stop",
      .type = ParameterType::map,
      .default_value = "/emergency_stop",
      .text =
          "ROS topic on which true stops the robot and false releases it, or a map of further "
          "keys; none: no topic",
      .inner = {text("topic", "/emergency_stop",
                     "Topic on which true stops the robot and false releases it; none: no topic"),
                text("message", "std_msgs/Bool", "Message type"),
                text("field", "data", "Path of the field that stops the robot when it is not 0"),
                boolean("latched", "The robot stays stopped until the end of the run"),
                boolean("required", "The robot is stopped while the topic has no publisher"),
                {.name = "timeout",
                 .unit = "s",
                 .default_value = "0",
                 .minimum = 0,
                 .text = "Wall time without a message after which the robot is stopped; 0: never"}},
      .plain_key = "topic",
      .example = "{topic: /stop, required: true}"};
}

Parameter override_parameter() {
  return {.name = "override",
          .type = ParameterType::map,
          .default_value = "",
          .text =
              "ROS topic of manual commands, which replace those of the network, or a map of "
              "further keys; none: no topic",
          .inner = {text("topic", "",
                         "Topic of manual commands, which replace those of the network; not given: "
                         "the topic of the commands with the suffix _manual; none: no topic"),
                    {.name = "timeout",
                     .unit = "s",
                     .default_value = "500 ms",
                     .minimum = 1e-3,
                     .text = "How long a manual command stays in effect"}},
          .plain_key = "topic",
          .example = "{topic: /by_hand, timeout: 1 s}"};
}

command::EmergencyStop emergency_stop(const Node& command, messages::Dialect ros) {
  const Parameters& keys = command.parameters.map("emergency_stop");
  if (keys.text("topic").empty()) {
    throw ConfigurationError(
        keys.where("topic"),
        with_code(Code::missing_key,
                  "key 'emergency_stop': there is no topic; write  /emergency_stop, or none"));
  }
  command::EmergencyStop result{.topic = topic_of(command, "emergency_stop", keys, ""),
                                .message_type = keys.text("message"),
                                .field = keys.text("field"),
                                .latched = keys.boolean("latched"),
                                .required = keys.boolean("required"),
                                .timeout = from_seconds(keys.number("timeout"))};
  if (result.topic.empty()) {
    return {};
  }
  try {
    const auto& catalog = messages::Catalog::for_type(ros, result.message_type);
    if (!is_definition_file(result.message_type)) {
      result.message_type = catalog.full_name(result.message_type);
    }
    messages::FieldReader(catalog, result.message_type, result.field);
  } catch (const ConfigurationError& error) {
    const char* about = keys.given("field") ? "field" : "message";
    throw ConfigurationError(
        keys.given(about) ? keys.where(about) : command.parameters.where("emergency_stop"),
        fmt::format("key 'emergency_stop': {}", reason_of(error)));
  }
  return result;
}

command::Override manual_override(const Node& command) {
  const Parameters& keys = command.parameters.map("override");
  const std::string topic =
      topic_of(command, "override", keys, command.parameters.text("topic") + "_manual");
  const Parameters& emergency = command.parameters.map("emergency_stop");
  if (!topic.empty() && topic == topic_of(command, "emergency_stop", emergency, "")) {
    throw ConfigurationError(
        command.parameters.where("override"),
        with_code(
            Code::topic_conflict,
            "key 'override': {} is the topic of the emergency stop; write another one, or none",
            topic));
  }
  return {.topic = topic, .timeout = from_seconds(keys.number("timeout"))};
}

command::CommandSettings command_settings(const Node& command, std::uint32_t width,
                                          const command::LoopClock& loop,
                                          const std::string& joint_states,
                                          std::optional<messages::Dialect> ros) {
  command::CommandSettings settings =
      command::command_settings(command.parameters, command.mapping, width, loop);
  settings.process = command.name;
  settings.topic = command.parameters.text("topic");
  settings.joint_states = command.parameters.text("joint_states");
  const auto holds_joint = [](const StopRule& rule) { return !rule.joint.empty(); };
  if (settings.joint_states == kNone || std::ranges::none_of(settings.stops, holds_joint)) {
    settings.joint_states.clear();
  } else if (settings.joint_states.empty()) {
    const std::string folder = settings.topic.substr(0, settings.topic.rfind('/') + 1);
    settings.joint_states = joint_states.empty() ? folder + "joint_states" : joint_states;
  }
  if (ros) {
    settings.emergency_stop = emergency_stop(command, *ros);
    settings.manual = manual_override(command);
    settings.guard_required = command.parameters.boolean("guard_required");
  }
  return settings;
}

std::string joint_state_sensor(const Experiment& experiment, const Node& command) {
  for (const Node* sensor : sensors_behind(experiment, command.name)) {
    if (sensor->parameters.text("message") == "sensor_msgs/JointState") {
      return sensor->parameters.text("topic");
    }
  }
  return "";
}

TimeNs spike_timeout(const Node& command) {
  return from_seconds(command.parameters.number("spike_timeout"));
}

std::vector<const Node*> sensors_behind(const Experiment& experiment, const std::string& name) {
  const auto names = behind(experiment, name, [](const Connection&) { return true; });
  std::vector<const Node*> sensors;
  for (const Node& node : experiment.nodes) {
    if (is_watched(node) && names.contains(node.name)) {
      sensors.push_back(&node);
    }
  }
  return sensors;
}

std::vector<command::WatchedSensor> watched_sensors(const Experiment& experiment,
                                                    const Node& command) {
  const Parameters& keys = command.parameters;
  const double otherwise = keys.number(keys.given("sensor_timeout") ? "sensor_timeout" : "max_age");
  std::vector<command::WatchedSensor> watched;
  for (const Node* sensor : sensors_behind(experiment, command.name)) {
    const Parameters& own = sensor->parameters;
    const double timeout = own.given("timeout") ? own.number("timeout") : otherwise;
    watched.push_back({own.text("topic"), from_seconds(timeout)});
  }
  return watched;
}

std::vector<const Connection*> spikes_behind(const Experiment& experiment,
                                             const std::string& node) {
  const auto names = behind(experiment, node, [](const Connection& connection) {
    return connection.kind != PortKind::spikes;
  });
  std::vector<const Connection*> connections;
  for (const Connection& connection : experiment.connections) {
    if (connection.kind == PortKind::spikes && names.contains(node_of(connection.to))) {
      connections.push_back(&connection);
    }
  }
  return connections;
}

std::vector<const Connection*> watched_spikes(const Experiment& experiment, const Node& command) {
  return spike_timeout(command) == 0 ? std::vector<const Connection*>{}
                                     : spikes_behind(experiment, command.name);
}

std::optional<Upstream> nearest_sensor(const Experiment& experiment, const std::string& node) {
  // Dijkstra, against the direction of the connections.
  std::set<std::pair<std::uint64_t, std::string>> open{{0, node}};
  std::set<std::string> done;
  while (!open.empty()) {
    const auto [distance, nearest] = *open.begin();
    open.erase(open.begin());
    if (!done.insert(nearest).second) {
      continue;
    }
    if (experiment.node(nearest).kind == kRosSensor) {
      return Upstream{nearest, static_cast<std::uint32_t>(distance)};
    }
    for (const Connection& connection : experiment.connections) {
      if (node_of(connection.to) == nearest) {
        open.emplace(distance + connection.delay_ticks.value_or(0), node_of(connection.from));
      }
    }
  }
  return std::nullopt;
}

}  // namespace spikeloop::experiment
