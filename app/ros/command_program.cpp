// ros_command_adapter: a continuous signal as command messages, and a robot that is never left
// driving.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "programs.hpp"
#include "sensor_topics.hpp"
#include "spikeloop/command/mapping.hpp"
#include "spikeloop/config/mapping_file.hpp"
#include "spikeloop/config/message_type.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/ros_command/command_endpoint.hpp"
#include "spikeloop/status/deadline.hpp"
#include "spikeloop/status/signals.hpp"
#include "spikeloop/topics/rosout.hpp"

namespace spikeloop {
namespace {

std::vector<ParameterDescription> command_parameters(const RosProgram& program) {
  const auto text = [](const char* name, const char* value, const char* line) {
    return ParameterDescription{
        .name = name, .type = ParameterType::text, .default_value = value, .text = line};
  };
  return program_parameters(
      program,
      {text("message_mapping_filename", program.mapping_file,
            "File that assigns channels to fields"),
       text("message_type", "", "FloatArray without a mapping file; with one, its type applies"),
       {.name = "command_update_rate",
        .unit = "Hz",
        .default_value = program.command_rate,
        .minimum = 0,
        .text = "Another spelling of command_rate"},
       {.name = "pipeline_ticks",
        .type = ParameterType::integer,
        .default_value = "0",
        .minimum = 0,
        .text = "Delay of the data relative to data_stamp, in ticks; data_stamp is delayed by it"},
       {.name = "default_limits",
        .type = ParameterType::boolean,
        .default_value = "false",
        .text = "Twist velocities without limits in the mapping file are limited to [-1, 1] m/s "
                "and [-3, 3] rad/s"},
       sensor_topics_parameter()});
}

// Each family had one of the two spellings and did not look at the other.
double command_rate(const Parameters& parameters, const RosProgram& program, bool strict) {
  const std::string own = program.command_rate_key;
  const std::string other =
      own == "command_rate" ? "command_update_rate" : std::string("command_rate");
  if (!parameters.given(own) && parameters.given(other)) {
    return parameters.number(other);
  }
  if (parameters.given(own) && parameters.given(other)) {
    const std::string text = with_code(
        Code::duplicate_key,
        "'command_rate' and 'command_update_rate' are two spellings of one key; leave out '{}'",
        other);
    if (strict) {
      throw ConfigurationError(parameters.where(other), text);
    }
    log::warning("{}", lengthened(text, fmt::format(", which {} ignores", program.name)));
  }
  return parameters.number(own);
}

CommandMapping all_channels() {
  return {.file = "", .message_type = "std_msgs/Float64MultiArray", .all_channels = true};
}

CommandMapping read_command_mapping(const music::Process& process, const Parameters& parameters) {
  const std::string& file = parameters.text("message_mapping_filename");
  const bool strict = process.common().strict;
  if (!file.empty()) {
    const Location& where = parameters.where("message_mapping_filename");
    return located_at(where, [&] {
      return read_mapping(
          file, {.base_directory = process.file_directory(), .strict = strict, .named_in = where});
    });
  }
  const std::string& type = parameters.text("message_type");
  const bool plain = !type.empty() && canonical_message_type(type) == "std_msgs/Float64MultiArray";
  if (!plain) {
    const std::string text = with_code(
        Code::missing_key,
        "section '{}' has no message_mapping_filename, which says which channel goes to which "
        "field; write it, or message_type=FloatArray to send all channels",
        process.label());
    if (strict) {
      throw ConfigurationError(text);
    }
    log::warning("{}", lengthened(text, "; a Float64MultiArray of all channels is sent"));
  }
  return all_channels();
}

/// With its mapping.
Section read_command(const music::Process& process, const RosProgram& program) {
  Section section = read_section(process, program, command_parameters(program));
  Parameters& parameters = section.node.parameters;
  const double rate = command_rate(section.keys, program, process.common().strict);
  parameters.set("command_rate", rate, section.keys.given("command_rate"),
                 section.keys.where("command_rate"));
  if (!section.keys.boolean("default_limits")) {
    parameters.set("limits", std::string(experiment::kNoLimits));
  }
  section.node.mapping = read_command_mapping(process, section.keys);
  experiment::read_endpoint(section.node, process.file_directory(), section.ros.ros);
  return section;
}

command::CommandSettings command_settings(const music::Process& process, const Section& section,
                                          std::uint32_t width,
                                          const std::vector<SensorTopic>& sensors) {
  const auto states =
      std::ranges::find(sensors, "sensor_msgs/JointState", &SensorTopic::message_type);
  const auto& common = process.common();
  command::CommandSettings settings = experiment::command_settings(
      section.node, width, {.tick = common.music_timestep, .real_time_factor = common.rtf},
      states == sensors.end() ? "" : states->sensor.topic, section.ros.ros);
  for (const SensorTopic& sensor : sensors) {
    settings.sensors.push_back(sensor.sensor);
  }
  return settings;
}

}  // namespace

music::ProgramText command_text(const RosProgram& program) {
  music::ProgramText text;
  text.name = program.name;
  text.summary = "Sends a continuous signal as ROS command messages";
  text.ports =
      "  in         input   continuous  Numbers to send\n"
      "  data_stamp input   continuous  [1] From ros_sensor_adapter: age of the data\n";
  text.parameters = command_parameters(program);
  text.example = fmt::format(
      "  [command]\n  binary={}\n  np=1\n  ros_topic=/cmd_vel\n"
      "  message_mapping_filename=twist.json\n  SENDER.out -> command.in [2]\n"
      "\ntwist.json:\n"
      "  {{\"message_type\": \"Twist\", \"mapping\": {{\"linear.x\": 0, \"angular.z\": 1}},\n"
      "   \"min\": -1, \"max\": 1}}\n",
      program.name);
  text.notes =
      "A command that changes by more than the deadband is sent at once. A stop command is sent\n"
      "when the run ends for any reason, when ticks are missing, when data are too old (needs the\n"
      "port data_stamp), and instead of a command with NaN or infinity.\n"
      "With SPIKELOOP_GUARD=PATH, spikeloop-guard sends it when this program is killed (SIGKILL)\n"
      "or stopped (SIGSTOP).\n"
      "Messages on emergency_stop and override take effect at once. See docs/safety.md.\n";
  return text;
}

int run_command(music::Process& process, const RosProgram& program) {
  process.declare_ports({"in", "data_stamp"});
  const Section section = read_command(process, program);
  const Parameters& keys = section.keys;
  const experiment::Node& node = section.node;
  const std::uint32_t width = process.width("in");
  check_channels(node.mapping, width);
  const auto in = process.signal_input("in");
  // Delayed until the data of the same message are here: what it says is these data's age.
  const auto data_stamp =
      process.connected_input("data_stamp", PortKind::signal)
          ? process.signal_input("data_stamp", static_cast<int>(keys.integer("pipeline_ticks")))
          : nullptr;

  const auto sensor_list = sensor_topics(keys, section.ros.ros);
  command::CommandSettings settings = command_settings(process, section, width, sensor_list);
  settings.with_data_stamp = data_stamp != nullptr;
  if (process.checking()) {
    process.check();
    return 0;
  }
  const auto session = session::open(section.ros);
  const status::TerminationHook on_termination([&] { session->leave(); });  // the last of all
  topics::Rosout rosout(*session);
  const NodeClass fields = command::command_map_class(command::components(node.mapping, width));
  ros_command::CommandEndpoint command(*session, settings);

  std::vector<std::unique_ptr<Source>> sensors;
  GraphDescription description;
  description.tick = process.common().music_timestep;
  description.seed = process.common().seed;
  description.sources = {{"in", in.get()}};
  description.nodes = {{"fields", &fields, {}, {}}};
  description.sinks = {{"topic", &command.sink()}};
  description.connections = {{"in.in", "fields.in", width, 0, {}},
                             {"fields.out", "topic.command", settings.width(), 0, {}}};
  if (data_stamp) {
    description.sources.push_back({"data_stamp", data_stamp.get()});
    description.connections.push_back({"data_stamp.data_stamp", "topic.data_stamp", 0, 0, {}});
  }
  for (const SensorTopic& watched : sensor_list) {
    const std::size_t i = sensors.size();
    sensors.push_back(arrivals(*session, watched));
    description.sources.push_back({fmt::format("sensor {}", i), sensors.back().get()});
    description.connections.push_back(
        {fmt::format("sensor {}.out", i), fmt::format("topic.sensor_{}", i), 1, 0, {}});
  }
  process.attach_recorders(description);
  if (data_stamp) {
    command.sink().on_latency(process.value_recorder("latency", "ms"));
  }
  Graph graph(description);
  music::Process::LoopHooks hooks;
  hooks.after_loop = [&] { command.stop(command::StopReason::ended); };
  hooks.summary = [&] { return command.summary(); };
  return status::end_in_time(rosout.during([&] { return process.run(graph, hooks); }));
}

}  // namespace spikeloop
