// A bag in the robot's place.
#include <fmt/ranges.h>

#include <filesystem>

#include "faults.hpp"
#include "spikeloop/bag/reader.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::experiment {
namespace {

bool is_sensor(const Node& node, const std::set<std::string>& whole) {
  return takes_messages(node.kind) && whole.contains(node.name);
}

/// The first tick at which something of this time is there.
TimeNs tick_of(TimeNs time, TimeNs tick) {
  return (time + tick - 1) / tick * tick;
}

std::string topics_in(const bag::Reader& reader) {
  std::set<std::string> topics;
  for (const bag::Connection& connection : reader.connections()) {
    topics.insert(fmt::format("{} ({})", connection.topic, connection.type));
  }
  return topics.empty() ? "nothing" : fmt::format("{}", fmt::join(topics, ", "));
}

void check_type(const Node& node, const bag::Connection& connection, messages::Dialect dialect) {
  const std::string& message = node.parameters.text("message");
  const Location where = node.parameters.where("message");
  if (connection.dialect != dialect) {
    throw ConfigurationError(
        where, with_code(Code::wrong_message,
                         "key 'message': the recording's topic {} has messages encoded as '{}'; a "
                         "sensor takes 'ros1' or 'cdr', and all sensors the same",
                         connection.topic, connection.encoding));
  }
  const auto& catalog =
      *located_at(where, [&] { return &messages::Catalog::for_type(dialect, message); });
  const std::string type = located_at(where, [&] { return catalog.full_name(message); });
  if (connection.type != type) {
    throw ConfigurationError(
        where,
        with_code(Code::wrong_message,
                  "key 'message': the recording's topic {0} carries {1}, not {2}; write  message: "
                  "{1}",
                  connection.topic, connection.type, type));
  }
  const bool ros1 = dialect == messages::Dialect::ros1;
  const std::string version = ros1 ? catalog.md5(type) : catalog.type_hash(type);
  if (connection.version != version) {
    throw ConfigurationError(
        where, with_code(Code::wrong_message,
                         "key 'message': the recording's topic {} carries another version of {} "
                         "({}, ours is {}); {}",
                         connection.topic, type, connection.version, version,
                         ros1 ? "'rosbag fix' makes it the version of ROS Noetic"
                              : "give the .msg file of that version"));
  }
}

void check_topic(const Node& node, const bag::Reader& reader) {
  const std::string& topic = node.parameters.text("topic");
  std::vector<std::string> topics;
  bool found = false;
  for (const bag::Connection& connection : reader.connections()) {
    if (connection.topic == topic) {
      check_type(node, connection, reader.dialect());
      found = true;
    }
    topics.push_back(connection.topic);
  }
  if (!found) {
    const std::string meant = nearest(topic, topics);
    throw ConfigurationError(
        node.parameters.where("topic"),
        with_code(Code::no_such_topic, "key 'topic': the recording has no topic {}{}; it has {}",
                  topic, meant.empty() ? "" : fmt::format("; did you mean '{}'?", meant),
                  topics_in(reader)));
  }
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

void read_bag_keys(const ExperimentNode& robot, const std::string& directory,
                   Experiment& experiment, Faults& faults) {
  Robot result;
  result.where = robot.keys.at("bag").where;
  result.bag = in_directory(directory, robot.keys.at("bag").text);
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

SensorWidth bag_width(std::shared_ptr<const bag::Reader> reader) {
  return [reader = std::move(reader)](const Node& sensor) -> std::optional<std::uint32_t> {
    try {
      check_topic(sensor, *reader);
    } catch (const ConfigurationError&) {
      return 0;  // told by check_bag()
    }
    bag::Stream stream = reader->stream(sensor.parameters.text("topic"), sensor.name);
    const auto first = stream.next();
    if (!first) {
      return 0;
    }
    return sensor.kind == kRosEventSensor
               ? count_channels(sensor.parameters, reader->dialect(), first->bytes)
               : count_values(sensor.parameters, reader->dialect(), first->bytes);
  };
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
