#include <fmt/format.h>

#include "programs.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop {

std::vector<ParameterDescription> connection_parameters(const RosProgram& program) {
  return {{.name = "ros_topic",
           .type = ParameterType::text,
           .default_value = program.topic,
           .text = *program.topic == '\0' ? "Topic; must be given" : "Topic"},
          {.name = "ros_node_name",
           .type = ParameterType::text,
           .default_value = program.node_name,
           .text = "Name of the ROS node; the default gets a suffix that makes it unique"},
          {.name = "ros",
           .type = ParameterType::choice,
           .default_value = "1",
           .choices = {"1", "2"},
           .text = "Version of ROS"},
          {.name = "ros_arguments",
           .type = ParameterType::text,
           .default_value = "",
           .text = "NAME:=VALUE ... as for any node of ROS: other names of topics, __ns"},
          {.name = "master_timeout",
           .unit = "s",
           .default_value = "5",
           .minimum = 0,
           .maximum = 86400,
           .text = "How long to wait for the master of ROS 1 (ROS_MASTER_URI)"}};
}

messages::Dialect ros_of(const Parameters& parameters) {
  return topics::dialect_of(parameters.text("ros") == "2" ? 2 : 1);
}

session::Settings session_settings(const Parameters& parameters) {
  session::Settings settings;
  settings.ros = ros_of(parameters);
  located_at(parameters.where("ros_node_name"),
             [&] { topics::check_node_name(settings.ros, parameters.text("ros_node_name")); });
  settings.node_name = parameters.text("ros_node_name");
  settings.unique_name = !parameters.given("ros_node_name");
  located_at(parameters.where("ros_arguments"), [&] {
    settings.arguments = topics::read_ros_arguments(parameters.text("ros_arguments"));
    topics::check_ros_arguments(settings.ros, settings.arguments);
  });
  settings.master_timeout = from_seconds(parameters.number("master_timeout"));
  return settings;
}

std::string required_topic(const music::Process& process, const Parameters& parameters,
                           const std::string& example) {
  const std::string& topic = parameters.text("ros_topic");
  if (topic.empty()) {
    throw ConfigurationError(
        parameters.where("ros_topic"),
        fmt::format("section '{}' has no ros_topic; write ros_topic={}", process.label(), example));
  }
  located_at(parameters.where("ros_topic"),
             [&] { topics::check_topic(ros_of(parameters), topic); });
  return topic;
}

}  // namespace spikeloop
