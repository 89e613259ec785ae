#include "spikeloop/experiment/music_job.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "faults.hpp"
#include "job_writer.hpp"
#include "spikeloop/config/older_programs.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/experiment/topic_section.hpp"
#include "spikeloop/sensing/sensor_keys.hpp"

namespace spikeloop::experiment {
namespace {

/// The mapping that a ros_command wrote in place, as the file that its program reads.
std::string mapping_text(const CommandMapping& mapping) {
  nlohmann::ordered_json json{{"message_type", mapping.message_type}};
  if (mapping.stop) {
    json["stop"] = stop_text(*mapping.stop);
  }
  for (const CommandField& field : mapping.fields) {
    auto& entry = json["mapping"][field.field];
    entry = {{"channel", field.channel}, {"scale", field.scale}, {"offset", field.offset}};
    if (field.minimum) {
      entry["min"] = *field.minimum;
    }
    if (field.maximum) {
      entry["max"] = *field.maximum;
    }
    if (field.slew) {
      entry["slew"] = *field.slew;
    }
    if (field.stop) {
      entry["stop"] = stop_text(*field.stop);
    }
  }
  return json.dump(2) + "\n";
}

/// What a ros_sensor takes, as the file that its program reads.
std::string sensor_text(const Node& sensor) {
  nlohmann::ordered_json json;
  for (const char* key : {"fields", "image"}) {
    if (const auto written = sensor.written.find(key); written != sensor.written.end()) {
      const WrittenValue& value = written->second;
      json[key] = value.entries ? nlohmann::ordered_json::parse(value.text)
                                : nlohmann::ordered_json(value.text);
    }
  }
  return json.dump(2) + "\n";
}

/// A value as a .music file has it: a list without brackets and quotation marks.
std::string plain_text(const WrittenValue& value) {
  if (!value.is_list()) {
    return value.text;
  }
  std::vector<std::string> texts;
  for (const WrittenEntry& entry : value.entries()) {
    texts.push_back(entry.value.text);
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

/// "continuous->spikes", for the launcher, which does not know a plug-in's class.
std::string kinds_of(const NodeClass& node_class) {
  std::string in = "spikes";
  std::string out = "spikes";
  for (const PortDescription& port : node_class.description.ports) {
    (port.direction == Direction::input ? in : out) =
        port.kind == PortKind::signal ? "continuous" : "spikes";
  }
  return in + "->" + out;
}

class Writer : JobWriter {
 public:
  Writer(const Experiment& experiment, const std::string& folder) : JobWriter(experiment, folder) {}

  MusicJob write() {
    write_globals();
    for (const Node& node : experiment_.nodes) {
      begin_section(node.name, node.where);
      write_section(node);
    }
    for (const Connection& connection : experiment_.connections) {
      write_connection(connection);
    }
    return std::move(job_);
  }

 private:
  /// Makes it a file of its own when it stands in place.
  std::string as_file(const Node& node, const std::string& key, const std::string& text,
                      const char* extension) {
    if (!is_in_place(text)) {
      return text;
    }
    const std::string name = fmt::format("{}.{}.{}", node.name, key, extension);
    job_.files[name] = text;
    return (std::filesystem::path(folder_) / name).string();
  }

  void write_section(const Node& node) {
    add(node, "np", "1");
    add_directory(node.where);
    if (is_simulator(node)) {
      add_script(node);
    } else if (node.kind == kRosSensor) {
      write_sensor(node);
    } else if (node.kind == kRosEventSensor) {
      write_event_sensor(node);
    } else if (node.kind == kRosCommand) {
      write_command(node);
    } else if (node.role == Role::source) {
      add(node, "binary", node.kind);
      add(node, "file", std::filesystem::absolute(node.parameters.text("file")).string());
      add(node, "stream", node.parameters.text("stream"));
    } else if (node.kind == kNetwork) {
      add(node, "binary", "spikeloop-network");
      const std::string& network = node.parameters.text("network");
      for (const auto& [name, value] : node.written) {
        add(node, name, value.text);
      }
      add(node, "network",
          is_in_place(network) ? as_file(node, "network", network, "yaml")
                               : std::filesystem::absolute(network).string());
    } else {
      write_node(node);
    }
    write_delay(node);
    if (!node.record) {
      add("record", "false");
    }
  }

  void write_node(const Node& node) {
    add(node, "binary", "spikeloop-node");
    add(node, "node", node.kind);
    if (!node.plugin.empty()) {
      add(node, "plugin", std::filesystem::absolute(node.plugin).string());
      add(node, "ports", kinds_of(*node.node_class));
    }
    for (const auto& [name, value] : node.written) {
      add(node, name, as_file(node, name, value.text, "json"));
    }
  }

  /// Numbers and choices that a section has as the experiment has them, and those whose default
  /// is another one in the program.
  void write_plain_keys(const Node& node, const char* program) {
    const auto keys = section_keys(node.kind);
    const auto declared = section_parameters(*find_ros_program(program));
    for (const ParameterDescription& parameter : node.node_class->description.parameters) {
      const auto key = std::ranges::find(keys, parameter.name, &SectionKey::name);
      const bool is_plain = parameter.type != ParameterType::text &&
                            parameter.type != ParameterType::list &&
                            parameter.type != ParameterType::map;
      if (key == keys.end() || !is_plain) {
        continue;
      }
      const auto& default_value =
          declared[static_cast<std::size_t>(key - keys.begin())].default_value;
      if (node.parameters.given(parameter.name)) {
        add(node, parameter.name, node.written.at(parameter.name).text);
      } else if (parameter.default_value && default_value != parameter.default_value) {
        add(node, parameter.name, *parameter.default_value);
      }
    }
  }

  void write_sensor(const Node& node) {
    add(node, "binary", "ros_sensor_adapter");
    add(node, "ros", name_of(experiment_.ros));
    add(node, "ros_topic", node.parameters.text("topic"), "topic");
    add(node, "message_type", node.parameters.text("message"), "message");
    const messages::SensorRule rule = sensing::sensor_rule(node.parameters);
    const auto written = node.written.find("fields");
    const bool options = written != node.written.end() &&
                         written->second.text.find_first_of("{=") != std::string::npos;
    if (!rule.fields.empty() && !options) {
      std::vector<std::string> paths;
      for (const messages::SensorField& field : rule.fields) {
        paths.push_back(field.path);
      }
      add(node, "fields", fmt::format("{}", fmt::join(paths, ",")));
    } else if (!rule.fields.empty() || rule.image) {
      add(node, "sensor_mapping_filename", as_file(node, "mapping", sensor_text(node), "json"),
          node.parameters.given("fields") ? "fields" : "image");
    }
    for (const char* key : {"beams", "angles", "range"}) {
      if (const auto value = node.written.find(key); value != node.written.end()) {
        add(node, key, plain_text(value->second));
      }
    }
    if (!takes_picture(node.parameters)) {
      add("strict", "false");  // messages may have any length, as in an experiment
    }
    add(node, "initial", node.parameters.text("initial"));
  }

  void write_event_sensor(const Node& node) {
    add(node, "binary", "ros_event_sensor_adapter");
    add(node, "ros", name_of(experiment_.ros));
    add(node, "ros_topic", node.parameters.text("topic"), "topic");
    add(node, "message_type", node.parameters.text("message"), "message");
    write_plain_keys(node, "ros_event_sensor_adapter");
    if (const auto roi = event_settings(node.parameters).region) {
      add(node, "roi", fmt::format("{},{},{},{}", roi->x, roi->y, roi->width, roi->height));
    }
  }

  void write_command(const Node& node) {
    add(node, "binary", "ros_command_adapter");
    add(node, "ros", name_of(experiment_.ros));
    add(node, "ros_topic", node.parameters.text("topic"), "topic");
    const std::string mapping = mapping_text(node.mapping);
    add(node, "message_mapping_filename", as_file(node, "mapping", mapping, "json"), "fields");
    write_plain_keys(node, "ros_command_adapter");
    add(node, "default_limits", node.parameters.word("limits") == kNoLimits ? "false" : "true",
        "limits");
    const std::string& written = node.parameters.text("joint_states");
    const std::string states = written.empty() ? joint_state_sensor(experiment_, node) : written;
    if (!states.empty()) {  // the program does not know all sensors
      add(node, "joint_states", states, "joint_states");
    }
    write_people(node);
    write_sensors_behind(node);
    if (spike_timeout(node) != 0) {
      throw ConfigurationError(node.parameters.where("spike_timeout"),
                               with_code(Code::layout,
                                         "key 'spike_timeout': an exported job has none, because "
                                         "no spike reaches the command's "
                                         "program; leave it out"));
    }
  }

  void write_people(const Node& node) {
    const command::EmergencyStop stop = emergency_stop(node, experiment_.dialect);
    const auto truth = [](bool value) { return value ? "true" : "false"; };
    const char* from = "emergency_stop";
    add(node, from, stop.topic.empty() ? "none" : stop.topic);
    add(node, "emergency_stop_message", stop.message_type, from);
    add(node, "emergency_stop_field", stop.field, from);
    add(node, "emergency_stop_latched", truth(stop.latched), from);
    add(node, "emergency_stop_required", truth(stop.required), from);
    add(node, "emergency_stop_timeout", seconds(stop.timeout), from);
    const command::Override manual = manual_override(node);
    add(node, "override", manual.topic.empty() ? "none" : manual.topic);
    add(node, "override_timeout", seconds(manual.timeout), "override");
  }

  /// Of a single sensor data_stamp tells the age; the topics of several are listened to once more.
  void write_sensors_behind(const Node& node) {
    const auto sensors = sensors_behind(experiment_, node.name);
    const auto watched = watched_sensors(experiment_, node);
    const TimeNs max_age = from_seconds(node.parameters.number("max_age"));
    std::vector<std::string> listed;
    for (std::size_t i = 0; i < watched.size(); ++i) {
      const bool by_data_stamp = watched.size() == 1 && sensors[i]->kind == kRosSensor &&
                                 max_age != 0 && max_age <= watched[i].timeout;
      if (watched[i].timeout != 0 && !by_data_stamp) {
        listed.push_back(fmt::format("{}:{}:{}", watched[i].topic,
                                     sensors[i]->parameters.text("message"),
                                     seconds(watched[i].timeout)));
      }
    }
    if (!listed.empty()) {
      add(node, "sensor_topics", fmt::format("{}", fmt::join(listed, ",")), "sensor_timeout");
    }
  }

  /// One key a section: all connections into it wait equally long.
  void write_delay(const Node& node) {
    const Connection* first = nullptr;
    for (const Connection& connection : experiment_.connections) {
      if (node_of(connection.to) != node.name) {
        continue;
      }
      check_delay(connection);
      if (first != nullptr && first->kind == connection.kind &&
          ticks(*first) != ticks(connection)) {
        throw ConfigurationError(
            connection.where,
            with_code(Code::layout,
                      "the inputs '{}' and '{}' have different delays, and the inputs of a program "
                      "in an exported job have one; write the same delay",
                      first->to, connection.to));
      }
      first = &connection;
      const std::uint32_t delay = ticks(connection);
      if (connection.kind == PortKind::spikes && delay > 0) {
        add(node, "spike_delay", std::to_string(delay));
        add(node, "accept_latency", seconds(delay * experiment_.tick));
      } else if (connection.kind == PortKind::signal && delay > 1) {
        add(node, "signal_delay", std::to_string(delay - 1));
      }
    }
  }

  static void check_delay(const Connection& connection) {
    if (connection.kind == PortKind::signal && connection.delay_ticks == 0U) {
      throw ConfigurationError(
          connection.where,
          with_code(
              Code::delay,
              "the continuous connection '{}' -> '{}' has the delay 0, but takes a tick in an "
              "exported job; write a delay of at least 1 tick, or leave it out",
              connection.from, connection.to));
    }
  }
  static std::uint32_t ticks(const Connection& connection) {
    return connection.delay_ticks.value_or(connection.kind == PortKind::signal ? 1 : 0);
  }

  void write_connection(const Connection& connection) {
    if (connection.combination != Combination::alone) {
      throw ConfigurationError(
          connection.where,
          with_code(Code::layout,
                    "input '{}' has several senders, which an exported job does not support; "
                    "connect one output to each input",
                    connection.to));
    }
    if (!connection.channels.all()) {
      throw ConfigurationError(
          connection.where,
          with_code(Code::layout,
                    "'{}' takes {} of '{}', and an exported job has no slices; connect all "
                    "channels",
                    connection.to, connection.channels.text(), connection.from));
    }
    MusicConnection written{node_of(connection.from),
                            port_of(connection.from),
                            node_of(connection.to),
                            port_of(connection.to),
                            connection.width,
                            {},
                            {},
                            connection.where};
    job_.file.connections.push_back(std::move(written));
  }
};

/// Programs know a port's width from its connection alone.
void check_ends(const Experiment& experiment) {
  for (const Node& node : experiment.nodes) {
    const bool sends = std::ranges::any_of(
        experiment.connections,
        [&](const Connection& connection) { return node_of(connection.from) == node.name; });
    const bool by_weights = std::ranges::any_of(
        node.node_class->description.parameters,
        [](const auto& parameter) { return parameter.type == ParameterType::weights; });
    if (by_weights && !sends) {
      throw ConfigurationError(
          node.where, with_code(Code::not_connected,
                                "nothing is connected to an output of '{}', and a program in an "
                                "exported job knows its width from a connection; connect it",
                                node.name));
    }
  }
}

}  // namespace

MusicJob music_job(const Experiment& experiment, const std::string& folder) {
  if (experiment.sync == Sync::lockstep || experiment.sync == Sync::sim_time) {
    throw ConfigurationError(
        experiment.sync_where,
        with_code(Code::layout, "key 'sync': an exported job has no {}; write realtime or unpaced",
                  name_of(experiment.sync)));
  }
  if (experiment.robot && !experiment.robot->bag.empty()) {
    throw ConfigurationError(
        experiment.robot->where,
        with_code(
            Code::layout,
            "an exported job has no bag in the robot's place; write  ros: 1, and play it with  "
            "rosbag play"));
  }
  if (experiment.robot && experiment.ros == Ros::none) {
    throw ConfigurationError(
        experiment.robot->where,
        with_code(Code::layout, "an exported job reaches the robot over ROS; write  ros: 2"));
  }
  check_ends(experiment);
  return Writer(experiment, folder).write();
}

}  // namespace spikeloop::experiment
