#include "safety_keys.hpp"

#include <fmt/format.h>

#include <sstream>

#include "spikeloop/command/mapping.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop {
namespace {

constexpr const char* kNone = "none";

[[noreturn]] void refuse_sensor(const Parameters& keys, const std::string& text) {
  throw ConfigurationError(
      keys.where("sensor_topics"),
      fmt::format("sensor_topics: '{}' is no topic with its type and timeout in s; write "
                  "sensor_topics=/scan:sensor_msgs/LaserScan:0.5, and others behind a comma",
                  text));
}

SensorTopic sensor_topic(const Parameters& keys, const std::string& text) {
  const auto first = text.find(':');
  const auto last = text.rfind(':');
  if (first == std::string::npos || last == first) {
    refuse_sensor(keys, text);
  }
  double timeout = 0;
  try {
    timeout = parse_quantity(text.substr(last + 1), "s");
  } catch (const ConfigurationError&) {
    refuse_sensor(keys, text);
  }
  if (!(timeout > 0 && timeout < 1e9)) {
    refuse_sensor(keys, text);
  }
  return {{text.substr(0, first), from_seconds(timeout)}, text.substr(first + 1, last - first - 1)};
}

std::string checked_topic(const Parameters& keys, const char* key, messages::Dialect ros,
                          const std::string& topic, const std::string& command_topic) {
  if (topic == command_topic) {
    throw ConfigurationError(
        keys.where(key),
        fmt::format("{}: {} is the topic of the commands themselves; write another one, or none",
                    key, topic));
  }
  located_at(keys.where(key), [&] { topics::check_topic(ros, topic); });
  return topic;
}

command::EmergencyStop emergency_stop(const Parameters& keys, messages::Dialect ros,
                                      const std::string& command_topic) {
  const std::string& topic = keys.text("emergency_stop");
  if (topic == kNone) {
    return {};
  }
  command::EmergencyStop stop{
      .topic = checked_topic(keys, "emergency_stop", ros, topic, command_topic),
      .message_type = keys.text("emergency_stop_message"),
      .field = keys.text("emergency_stop_field"),
      .latched = keys.boolean("emergency_stop_latched"),
      .required = keys.boolean("emergency_stop_required"),
      .timeout = from_seconds(keys.number("emergency_stop_timeout"))};
  const char* about =
      keys.given("emergency_stop_field") ? "emergency_stop_field" : "emergency_stop_message";
  return located_at(keys.where(about), [&] {
    const auto& catalog = messages::Catalog::for_type(ros, stop.message_type);
    stop.message_type = catalog.full_name(stop.message_type);
    messages::FieldReader(catalog, stop.message_type, stop.field);
    return stop;
  });
}

}  // namespace

std::vector<ParameterDescription> safety_parameters() {
  const auto text = [](const char* name, const char* value, const char* line) {
    return ParameterDescription{
        .name = name, .type = ParameterType::text, .default_value = value, .text = line};
  };
  const auto boolean = [](const char* name, const char* line) {
    return ParameterDescription{
        .name = name, .type = ParameterType::boolean, .default_value = "false", .text = line};
  };
  const auto time = [](const char* name, const char* value, double minimum, const char* line) {
    return ParameterDescription{
        .name = name, .unit = "s", .default_value = value, .minimum = minimum, .text = line};
  };
  return {
      boolean("default_limits",
              "Velocities of a Twist without limits in the mapping file have [-1, 1] m/s and "
              "[-3, 3] rad/s, as in experiments"),
      text("sensor_topics", "",
           "Topics that stop the robot when they are silent, as TOPIC:TYPE:SECONDS,..."),
      text("emergency_stop", "/emergency_stop",
           "Topic on which a message stops the robot, or releases it; none"),
      text("emergency_stop_message", "std_msgs/Bool", "Its type"),
      text("emergency_stop_field", "data", "Path of the number that stops the robot if not 0"),
      boolean("emergency_stop_latched", "Once stopped, the robot stands until the run is over"),
      boolean("emergency_stop_required", "The robot stands while the topic has no publisher"),
      time("emergency_stop_timeout", "0", 0,
           "Time without a message that stops the robot (wall); 0: any"),
      text(
          "override", "",
          "Topic of commands by hand, in place of the network's; not given: ros_topic with _manual "
          "behind it; none"),
      time("override_timeout", "0.5", 1e-3, "So long a command by hand holds (wall)")};
}

std::vector<SensorTopic> sensor_topics(const Parameters& keys, messages::Dialect ros) {
  std::vector<SensorTopic> topics;
  std::istringstream list(keys.text("sensor_topics"));
  for (std::string text; std::getline(list, text, ',');) {
    SensorTopic topic = sensor_topic(keys, text);
    topics.push_back(located_at(keys.where("sensor_topics"), [&] {
      topics::check_topic(ros, topic.sensor.topic);
      topic.message_type =
          messages::Catalog::for_type(ros, topic.message_type).full_name(topic.message_type);
      return topic;
    }));
  }
  return topics;
}

void add_safety(const Parameters& keys, const CommandMapping& mapping, const std::string& topic,
                messages::Dialect ros, command::CommandSettings& settings) {
  settings.fields = command::field_paths(mapping);
  if (keys.boolean("default_limits")) {
    settings.bounds = command::default_bounds(mapping, std::move(settings.bounds));
  }
  for (const SensorTopic& sensor : sensor_topics(keys, ros)) {
    settings.sensors.push_back(sensor.sensor);
  }
  settings.emergency_stop = emergency_stop(keys, ros, topic);
  const std::string& manual = keys.text("override");
  settings.manual.timeout = from_seconds(keys.number("override_timeout"));
  if (manual != kNone) {
    settings.manual.topic =
        checked_topic(keys, "override", ros, manual.empty() ? topic + "_manual" : manual, topic);
    if (settings.manual.topic == settings.emergency_stop.topic) {
      throw ConfigurationError(
          keys.where("override"),
          fmt::format("override: {} is the topic of the emergency stop; write another one, or none",
                      settings.manual.topic));
    }
  }
}

}  // namespace spikeloop
