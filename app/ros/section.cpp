#include <algorithm>
#include <iterator>
#include <utility>

#include "programs.hpp"
#include "spikeloop/experiment/topic_section.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop {
namespace {

std::vector<ParameterDescription> connection_parameters(const RosProgram& program) {
  return {{.name = "ros_node_name",
           .type = ParameterType::text,
           .default_value = program.node_name,
           .text = "Name of the ROS node; over ROS 1 the default gets a unique suffix"},
          {.name = "ros",
           .type = ParameterType::choice,
           .default_value = "1",
           .choices = {"1", "2"},
           .text = "ROS version"},
          {.name = "ros_arguments",
           .type = ParameterType::text,
           .default_value = "",
           .text = "NAME:=VALUE ... as for any ROS node: remapped topics, __ns"},
          {.name = "master_timeout",
           .unit = "s",
           .default_value = "5",
           .minimum = 0,
           .maximum = 86400,
           .text = "Time to wait for the ROS 1 master (ROS_MASTER_URI)"}};
}

/// A name that the file gives is taken as it is; the default gets a suffix of its own over ROS 1,
/// so that a second adapter does not end the first one.
session::Settings session_settings(const Parameters& keys) {
  session::Settings settings;
  settings.ros = topics::dialect_of(keys.text("ros") == "2" ? 2 : 1);
  located_at(keys.where("ros_node_name"),
             [&] { topics::check_node_name(settings.ros, keys.text("ros_node_name")); });
  settings.node_name = keys.text("ros_node_name");
  settings.unique_name = !keys.given("ros_node_name");
  located_at(keys.where("ros_arguments"), [&] {
    settings.arguments = topics::read_ros_arguments(keys.text("ros_arguments"));
    topics::check_ros_arguments(settings.ros, settings.arguments);
  });
  settings.master_timeout = from_seconds(keys.number("master_timeout"));
  return settings;
}

/// An empty value of a list, or of a key that must be given, is none.
Parameters read_keys(const music::Process& process,
                     const std::vector<ParameterDescription>& declared) {
  WrittenValues written = process.written(names_of(declared));
  for (const ParameterDescription& parameter : declared) {
    const auto value = written.find(parameter.name);
    const bool may_be_empty = parameter.type != ParameterType::list && parameter.default_value;
    if (value != written.end() && value->second.text.empty() && !may_be_empty) {
      written.erase(value);
    }
  }
  return resolve(declared, written, {});
}

}  // namespace

std::vector<ParameterDescription> program_parameters(const RosProgram& program,
                                                     std::vector<ParameterDescription> own) {
  std::vector<ParameterDescription> parameters = experiment::section_parameters(program);
  std::ranges::move(own, std::back_inserter(parameters));
  std::ranges::move(connection_parameters(program), std::back_inserter(parameters));
  return parameters;
}

ParameterDescription update_rate_parameter() {
  return {.name = "sensor_update_rate",
          .unit = "Hz",
          .default_value = "30",
          .minimum = 0,
          .text = "No effect, for older files; messages are used when they arrive"};
}

Section read_section(const music::Process& process, const RosProgram& program,
                     const std::vector<ParameterDescription>& declared) {
  Section section;
  section.keys = read_keys(process, declared);
  section.ros = session_settings(section.keys);
  section.node.name = process.label();
  section.node.kind = program.node_class;
  section.node.node_class = &experiment::topic_class(program.node_class);
  section.node.parameters = experiment::class_parameters(program, section.keys);
  section.node.where = process.where();
  return section;
}

}  // namespace spikeloop
