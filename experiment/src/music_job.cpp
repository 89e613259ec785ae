#include "spikeloop/experiment/music_job.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "faults.hpp"
#include "job_writer.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/experiment/simulators.hpp"

namespace spikeloop::experiment {
namespace {

/// The mapping that a ros_command wrote in place, as the file that its program reads.
std::string mapping_text(const CommandMapping& mapping) {
  nlohmann::ordered_json json{{"message_type", mapping.message_type}};
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
  }
  return json.dump(2) + "\n";
}

/// What a ros_sensor takes, as the file that its program reads.
std::string sensor_text(const Part& sensor) {
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
    for (const Part& part : experiment_.parts) {
      begin_section(part.name, part.where);
      write_section(part);
    }
    for (const Link& link : experiment_.links) {
      write_connection(link);
    }
    return std::move(job_);
  }

 private:
  /// Makes it a file of its own when it stands in place.
  std::string as_file(const Part& part, const std::string& key, const std::string& text,
                      const char* extension) {
    if (!is_in_place(text)) {
      return text;
    }
    const std::string name = fmt::format("{}.{}.{}", part.name, key, extension);
    job_.files[name] = text;
    return (std::filesystem::path(folder_) / name).string();
  }

  void write_section(const Part& part) {
    add(part, "np", "1");
    add_directory(part.where);
    if (is_simulator(part)) {
      add_script(part);
    } else if (part.kind == kRosSensor) {
      write_sensor(part);
    } else if (part.kind == kRosEventSensor) {
      write_event_sensor(part);
    } else if (part.kind == kRosCommand) {
      write_command(part);
    } else if (part.role == Role::source) {
      add(part, "binary", part.kind);
      add(part, "file", std::filesystem::absolute(part.parameters.text("file")).string());
      add(part, "stream", part.parameters.text("stream"));
    } else if (part.kind == kNetwork) {
      add(part, "binary", "spikeloop-network");
      const std::string& network = part.parameters.text("network");
      add(part, "network",
          is_in_place(network) ? as_file(part, "network", network, "yaml")
                               : std::filesystem::absolute(network).string());
    } else {
      write_node(part);
    }
    write_delay(part);
  }

  void write_node(const Part& part) {
    add(part, "binary", "spikeloop-node");
    add(part, "node", part.kind);
    if (!part.plugin.empty()) {
      add(part, "plugin", std::filesystem::absolute(part.plugin).string());
      add(part, "ports", kinds_of(*part.node_class));
    }
    for (const auto& [name, value] : part.written) {
      add(part, name, as_file(part, name, value.text, "json"));
    }
  }

  void write_sensor(const Part& part) {
    add(part, "binary", "ros_sensor_adapter");
    add(part, "ros", name_of(experiment_.ros));
    add(part, "ros_topic", part.parameters.text("topic"), "topic");
    add(part, "message_type", part.parameters.text("message"), "message");
    const messages::SensorRule rule = sensor_rule(part.parameters);
    const auto written = part.written.find("fields");
    const bool options = written != part.written.end() &&
                         written->second.text.find_first_of("{=") != std::string::npos;
    if (!rule.fields.empty() && !options) {
      std::vector<std::string> paths;
      for (const messages::SensorField& field : rule.fields) {
        paths.push_back(field.path);
      }
      add(part, "fields", fmt::format("{}", fmt::join(paths, ",")));
    } else if (!rule.fields.empty() || rule.image) {
      add(part, "sensor_mapping_filename", as_file(part, "mapping", sensor_text(part), "json"),
          part.parameters.given("fields") ? "fields" : "image");
    }
    add(part, "initial", part.parameters.text("initial"));
  }

  void write_event_sensor(const Part& part) {
    add(part, "binary", "ros_event_sensor_adapter");
    add(part, "ros", name_of(experiment_.ros));
    add(part, "ros_topic", part.parameters.text("topic"), "topic");
    add(part, "message_type", part.parameters.text("message"), "message");
    for (const char* key : {"polarity", "downsample", "latency", "refractory"}) {
      if (part.parameters.given(key)) {
        add(part, key, part.written.at(key).text);
      }
    }
    if (const auto roi = event_settings(part.parameters).region) {
      add(part, "roi", fmt::format("{},{},{},{}", roi->x, roi->y, roi->width, roi->height));
    }
  }

  void write_command(const Part& part) {
    add(part, "binary", "ros_command_adapter");
    add(part, "ros", name_of(experiment_.ros));
    add(part, "ros_topic", part.parameters.text("topic"), "topic");
    const std::string mapping = mapping_text(part.mapping);
    add(part, "message_mapping_filename", as_file(part, "mapping", mapping, "json"), "fields");
    for (const char* key : {"command_rate", "deadband", "min_interval", "watchdog", "max_age"}) {
      if (part.parameters.given(key)) {
        add(part, key, part.written.at(key).text);
      }
    }
    add(part, "default_limits", part.parameters.word("limits") == kNoLimits ? "false" : "true",
        "limits");
    write_people(part);
    write_sensors_behind(part);
    if (spike_timeout(part) != 0) {
      throw ConfigurationError(
          part.parameters.where("spike_timeout"),
          "key 'spike_timeout': the separate layout has none, because no spike reaches the "
          "command's process; leave it out, or use the fused layout");
    }
  }

  void write_people(const Part& part) {
    const command::EmergencyStop stop = emergency_stop(part, dialect_of(experiment_.ros));
    const auto truth = [](bool value) { return value ? "true" : "false"; };
    const char* from = "emergency_stop";
    add(part, from, stop.topic.empty() ? "none" : stop.topic);
    add(part, "emergency_stop_message", stop.message_type, from);
    add(part, "emergency_stop_field", stop.field, from);
    add(part, "emergency_stop_latched", truth(stop.latched), from);
    add(part, "emergency_stop_required", truth(stop.required), from);
    add(part, "emergency_stop_timeout", seconds(stop.timeout), from);
    const command::Override manual = manual_override(part);
    add(part, "override", manual.topic.empty() ? "none" : manual.topic);
    add(part, "override_timeout", seconds(manual.timeout), "override");
  }

  /// Of a single sensor the pace tells the age; the topics of several are listened to once more.
  void write_sensors_behind(const Part& part) {
    const auto sensors = sensors_behind(experiment_, part.name);
    const auto watched = watched_sensors(experiment_, part);
    const TimeNs max_age = from_seconds(part.parameters.number("max_age"));
    std::vector<std::string> listed;
    for (std::size_t i = 0; i < watched.size(); ++i) {
      const bool by_pace = watched.size() == 1 && sensors[i]->kind == kRosSensor && max_age != 0 &&
                           max_age <= watched[i].timeout;
      if (watched[i].timeout != 0 && !by_pace) {
        listed.push_back(fmt::format("{}:{}:{}", watched[i].topic,
                                     sensors[i]->parameters.text("message"),
                                     seconds(watched[i].timeout)));
      }
    }
    if (!listed.empty()) {
      add(part, "sensor_topics", fmt::format("{}", fmt::join(listed, ",")), "sensor_timeout");
    }
  }

  /// One key a section: all connections into it wait equally long.
  void write_delay(const Part& part) {
    const Link* first = nullptr;
    for (const Link& link : experiment_.links) {
      if (node_of(link.to) != part.name) {
        continue;
      }
      check_delay(link);
      if (first != nullptr && first->kind == link.kind && ticks(*first) != ticks(link)) {
        throw ConfigurationError(
            link.where,
            fmt::format("the inputs '{}' and '{}' have different delays, which the separate layout "
                        "does not have; write one delay, or use the fused layout",
                        first->to, link.to));
      }
      first = &link;
      const std::uint32_t delay = ticks(link);
      if (link.kind == PortKind::spikes && delay > 0) {
        add(part, "spike_delay", std::to_string(delay));
        add(part, "accept_latency", seconds(delay * experiment_.tick));
      } else if (link.kind == PortKind::signal && delay > 1) {
        add(part, "signal_delay", std::to_string(delay - 1));
      }
    }
  }

  static void check_delay(const Link& link) {
    if (link.kind == PortKind::signal && link.delay_ticks == 0U) {
      throw ConfigurationError(
          link.where, fmt::format("the continuous connection '{}' -> '{}' has the delay 0, but "
                                  "between processes it takes a tick; write a delay of at least 1 "
                                  "tick, leave it out, or use the fused layout",
                                  link.from, link.to));
    }
  }
  static std::uint32_t ticks(const Link& link) {
    return link.delay_ticks.value_or(link.kind == PortKind::signal ? 1 : 0);
  }

  void write_connection(const Link& link) {
    MusicConnection connection{node_of(link.from),
                               port_of(link.from),
                               node_of(link.to),
                               port_of(link.to),
                               link.width,
                               {},
                               {},
                               link.where};
    job_.file.connections.push_back(std::move(connection));
  }
};

/// Programs know a port's width from its connection alone.
void check_ends(const Experiment& experiment) {
  for (const Part& part : experiment.parts) {
    const bool sends = std::ranges::any_of(
        experiment.links, [&](const Link& link) { return node_of(link.from) == part.name; });
    const bool by_weights = std::ranges::any_of(
        part.node_class->description.parameters,
        [](const auto& parameter) { return parameter.type == ParameterType::weights; });
    if (by_weights && !sends) {
      throw ConfigurationError(
          part.where, fmt::format("nothing is connected to an output of '{}', and the separate "
                                  "layout knows its width from a connection alone; connect it, or "
                                  "use the fused layout",
                                  part.name));
    }
  }
}

}  // namespace

MusicJob music_job(const Experiment& experiment, const std::string& folder) {
  if (experiment.sync == Sync::lockstep || experiment.sync == Sync::sim_time) {
    throw ConfigurationError(
        experiment.sync_where,
        fmt::format("key 'sync': the separate layout has no {}; write realtime or unpaced, or use "
                    "the fused layout",
                    name_of(experiment.sync)));
  }
  if (experiment.robot && !experiment.robot->bag.empty()) {
    throw ConfigurationError(experiment.robot->where,
                             "a bag in the robot's place needs the fused layout; in the separate "
                             "one write  ros: 1, and play it by  rosbag play");
  }
  if (experiment.robot && experiment.ros == Ros::none) {
    throw ConfigurationError(experiment.robot->where,
                             "in the separate layout the robot is reached over ROS; write  ros: 2, "
                             "or use the fused layout");
  }
  check_ends(experiment);
  return Writer(experiment, folder).write();
}

}  // namespace spikeloop::experiment
