// A bag in the robot's place.
#include <fmt/format.h>

#include <filesystem>

#include "faults.hpp"
#include "spikeloop/bag/reader.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/experiment/recording.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/recorded_type.hpp"
#include "spikeloop/sensing/sensor_keys.hpp"

namespace spikeloop::experiment {
namespace {

constexpr int kComparedMessages = 1000;

bool is_sensor(const Node& node, const std::set<std::string>& whole) {
  return takes_messages(node.kind) && whole.contains(node.name);
}

/// The first tick at which something of this time is there.
TimeNs tick_of(TimeNs time, TimeNs tick) {
  return (time + tick - 1) / tick * tick;
}

const messages::Catalog& catalog_of(const Node& node, messages::Dialect dialect) {
  return messages::Catalog::for_type(dialect, node.parameters.text("message"));
}

/// The names of `missing` that the node reads.
std::vector<std::string> read_fields(const Node& node, const std::vector<std::string>& missing) {
  std::vector<std::string> read;
  if (node.kind != kRosEventSensor) {
    for (const auto& field : sensing::sensor_rule(node.parameters).fields) {
      const std::string first = field.path.substr(0, field.path.find_first_of(".["));
      if (std::ranges::find(missing, first) != missing.end()) {
        read.push_back(first);
      }
    }
  }
  return read;
}

[[noreturn]] void refuse_version(const Node& node, const bag::Connection& connection,
                                 std::string_view type, std::string_view why) {
  const bool ros1 = connection.dialect == messages::Dialect::ros1;
  throw ConfigurationError(
      node.parameters.where("message"),
      with_code(Code::wrong_message,
                "key 'message': the recording's topic {} carries another version of {}: {}; {}",
                connection.topic, type, why,
                ros1 ? "'rosbag fix' makes it the version of ROS Noetic"
                     : "give the .msg file of that version"));
}

/// Compares definition and first message with the definition that the node uses.
/// @returns a warning, or nothing
std::string check_version(const Node& node, const bag::Connection& connection,
                          const std::string& type, const bag::Reader& reader) {
  messages::RecordedTopic recorded = bag::recorded_topic(reader, connection, node.name);
  recorded.type = type;
  const messages::Comparison found =
      messages::compare_recorded(recorded, catalog_of(node, *connection.dialect));
  if (found.fit == messages::Fit::other) {
    refuse_version(node, connection, type, found.detail);
  }
  if (const auto missing = read_fields(node, found.missing); !missing.empty()) {
    refuse_version(node, connection, type,
                   fmt::format("its messages have no field '{}'", missing.front()));
  }
  return messages::replacement_warning(recorded, found);
}

/// @returns a warning, or nothing
std::string check_type(const Node& node, const bag::Connection& connection,
                       const bag::Reader& reader) {
  const std::string& message = node.parameters.text("message");
  const Location where = node.parameters.where("message");
  if (connection.dialect != reader.dialect()) {
    throw ConfigurationError(
        where, with_code(Code::wrong_message,
                         "key 'message': the recording's topic {} has messages encoded as '{}'; a "
                         "sensor takes 'ros1' or 'cdr', and all sensors the same",
                         connection.topic, connection.encoding));
  }
  const auto& catalog = *located_at(where, [&] { return &catalog_of(node, reader.dialect()); });
  const std::string type = located_at(where, [&] { return catalog.full_name(message); });
  if (!connection.type.empty() && connection.type != type) {
    throw ConfigurationError(
        where,
        with_code(Code::wrong_message,
                  "key 'message': the recording's topic {0} carries {1}, not {2}; {3}",
                  connection.topic, connection.type, type,
                  messages::Catalog::builtin(*connection.dialect).contains(connection.type)
                      ? fmt::format("write  message: {}", connection.type)
                      : "Spikeloop does not know its type; write the path of its .msg file"));
  }
  return check_version(node, connection, type, reader);
}

/// @returns warnings
std::set<std::string> check_topic(const Node& node, const bag::Reader& reader) {
  const std::string& topic = node.parameters.text("topic");
  std::vector<std::string> topics;
  std::set<std::string> warnings;
  bool found = false;
  for (const bag::Connection& connection : reader.connections()) {
    if (connection.topic == topic) {
      warnings.insert(check_type(node, connection, reader));
      found = true;
    }
    topics.push_back(connection.topic);
  }
  if (!found) {
    if (topics.empty()) {
      throw ConfigurationError(
          node.parameters.where("topic"),
          with_code(Code::no_such_topic,
                    "key 'topic': topic {} has no messages in the recording, nor has any other "
                    "topic; give another recording",
                    topic));
    }
    const std::string meant = nearest(topic, topics);
    throw ConfigurationError(
        node.parameters.where("topic"),
        with_code(Code::no_such_topic, "key 'topic': the recording has no topic {}{}; it has {}",
                  topic, meant.empty() ? "" : fmt::format("; did you mean '{}'?", meant),
                  bag::list_topics(reader)));
  }
  warnings.erase("");
  return warnings;
}

/// The tick that uses the last message is run as well.
void end_with(const bag::Reader& reader, const std::set<std::string>& whole,
              Experiment& experiment) {
  TimeNs end = tick_of(reader.end(), experiment.tick);
  for (const Node& node : experiment.nodes) {
    if (is_sensor(node, whole)) {
      const auto last = reader.end_of(node.parameters.text("topic"));
      end = std::max(end, last ? tick_of(*last, experiment.tick) + experiment.tick : 0);
    }
  }
  experiment.duration = end;
}

}  // namespace

std::vector<std::string> recording_warnings(const Experiment& experiment,
                                            const bag::Reader& reader) {
  std::vector<std::string> warnings = reader.warnings();
  std::set<std::string> told;
  for (const Node& node : experiment.nodes) {
    if (takes_messages(node.kind)) {
      try {
        told.merge(check_topic(node, reader));
      } catch (const ConfigurationError&) {  // check_bag() reports it; a replay allows it
      }
    }
  }
  warnings.insert(warnings.end(), told.begin(), told.end());
  return warnings;
}

void read_bag_keys(const ExperimentNode& robot, const std::string& directory,
                   Experiment& experiment, Faults& faults) {
  Robot result;
  result.where = robot.keys.at("bag").where;
  result.bag = in_directory(directory, robot.keys.at("bag").text);
  while (result.bag.size() > 1 && result.bag.ends_with('/')) {
    result.bag.pop_back();  // a folder
  }
  std::vector<ParameterDescription> declared;
  WrittenValues written = robot.keys;
  for (const ParameterDescription& parameter : robot_parameters()) {
    if (parameter.name == "bag") {
      declared.push_back(parameter);
    } else if (written.erase(parameter.name) > 0) {
      faults.add(robot.places.at(parameter.name),
                 with_code(Code::conflicting_keys,
                           "robot: key '{}' is for a robot that is simulated, and the bag stands "
                           "in its place; leave one of the two out",
                           parameter.name));
    }
  }
  resolve_keys(declared, {written, "robot", robot.where, robot.unread, robot.places}, {}, faults);
  if (experiment.ros != Ros::none) {
    faults.add(result.where,
               with_code(Code::conflicting_keys,
                         "key 'bag': a bag stands in the place of robot and ROS; leave  ros  out"));
  }
  experiment.robot = result;
}

std::shared_ptr<const bag::Reader> open_bag(const Experiment& experiment, Faults& faults) {
  std::shared_ptr<const bag::Reader> reader;
  if (experiment.robot && !experiment.robot->bag.empty()) {
    const Robot& robot = *experiment.robot;
    faults.attempt(robot.where, [&] {
      if (!std::filesystem::exists(robot.bag)) {
        refuse_file("bag", robot.where, "bag", robot.bag);
      }
      reader = std::make_shared<const bag::Reader>(robot.bag);
    });
  }
  return reader;
}

namespace {

/// " in 'velocity'": the fields that a sensor reads. Empty for the default fields.
std::string in_fields(const Node& sensor) {
  std::vector<std::string> paths;
  for (const auto& field : sensing::sensor_rule(sensor.parameters).fields) {
    paths.push_back(field.path);
  }
  return paths.empty() ? "" : fmt::format(" in '{}'", fmt::join(paths, "', '"));
}

/// Width of the first message with a value. 0: the topic has no message.
/// @throws ConfigurationError as count_channels; UnusableMessages if no message has a value
std::uint32_t recorded_width(const Node& sensor, const bag::Reader& reader) {
  bag::Stream stream = reader.stream(sensor.parameters.text("topic"), sensor.name);
  std::uint64_t count = 0;
  std::uint64_t malformed = 0;
  std::string reason;
  for (auto message = stream.next(); message; message = stream.next(), ++count) {
    try {
      const std::uint32_t width = count_channels(sensor, reader.dialect(), message->bytes);
      if (width != 0) {
        return width;
      }
    } catch (const TransportError& error) {
      reason = malformed++ == 0 ? error.what() : reason;
    }
  }
  if (count == 0) {
    return 0;
  }
  const std::string counters = malformed == count ? fmt::format("malformed: {}", malformed)
                               : malformed == 0   ? fmt::format("without_reading: {}", count)
                                                : fmt::format("malformed: {}, without_reading: {}",
                                                              malformed, count - malformed);
  throw UnusableMessages(
      sensor.where,
      fmt::format("none of the {} messages of '{}' was usable ({}): topic '{}': a {} {}", count,
                  sensor.name, counters, sensor.parameters.text("topic"),
                  sensor.parameters.text("message"),
                  malformed == 0 ? "brought no reading" + in_fields(sensor)
                                 : "could not be read: " + reason));
}

}  // namespace

SensorWidth bag_width(std::shared_ptr<const bag::Reader> reader) {
  return [reader = std::move(reader)](const Node& sensor) -> std::optional<std::uint32_t> {
    check_topic(sensor, *reader);
    return recorded_width(sensor, *reader);
  };
}

bool length_changes(const bag::Reader& reader, const Node& sensor) {
  bag::Stream stream = reader.stream(sensor.parameters.text("topic"), sensor.name);
  std::uint32_t first = 0;
  for (int i = 0; i < kComparedMessages; ++i) {
    const auto message = stream.next();
    if (!message) {
      break;
    }
    std::uint32_t width = 0;
    try {
      width = count_channels(sensor, reader.dialect(), message->bytes);
    } catch (const TransportError&) {  // the run leaves it out
    }
    if (first != 0 && width != 0 && width != first) {
      return true;
    }
    first = first == 0 ? width : first;
  }
  return false;
}

void check_bag(const bag::Reader& reader, const std::set<std::string>& whole,
               Experiment& experiment, Faults& faults) {
  for (const Node& node : experiment.nodes) {
    if (is_sensor(node, whole)) {
      faults.attempt(node.where, [&] { check_topic(node, reader); });
    }
  }
  if (!experiment.duration) {
    faults.attempt(experiment.robot->where, [&] { end_with(reader, whole, experiment); });
  }
}

}  // namespace spikeloop::experiment
