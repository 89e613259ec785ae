// ros_command_adapter: a continuous signal as command messages, and a robot that is never left
// driving.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "programs.hpp"
#include "safety_keys.hpp"
#include "spikeloop/command/command_map_node.hpp"
#include "spikeloop/command/command_settings.hpp"
#include "spikeloop/command/mapping.hpp"
#include "spikeloop/config/mapping_file.hpp"
#include "spikeloop/config/message_type.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/ros_command/arrivals.hpp"
#include "spikeloop/ros_command/command_endpoint.hpp"
#include "spikeloop/topics/publisher.hpp"

namespace spikeloop {
namespace {

std::vector<ParameterDescription> command_parameters(const RosProgram& program) {
  auto parameters = connection_parameters(program);
  const auto number = [&](const char* name, const char* unit, const char* value, const char* text) {
    parameters.push_back(
        {.name = name, .unit = unit, .default_value = value, .minimum = 0, .text = text});
  };
  const auto words = [&](const char* name, const char* value, const char* text) {
    parameters.push_back(
        {.name = name, .type = ParameterType::text, .default_value = value, .text = text});
  };
  words("message_mapping_filename", program.mapping_file,
        "File that says which channel goes to which field");
  words("message_type", "", "Without a mapping file: FloatArray; with one, the file decides");
  number("command_rate", "Hz", program.command_rate,
         "Commands are sent again that often, times rtf; 0: never");
  number("command_update_rate", "Hz", program.command_rate, "Another spelling of command_rate");
  number("deadband", "1", "0.01",
         "Part of its range by which a field must move to be sent at once");
  number("min_interval", "s", "0.01",
         "Least time between two commands (wall); not given: one tick, at least 10 ms, less half a "
         "tick's jitter");
  number("watchdog", "s", "0.1",
         "Time without a tick after which a zero is sent (wall); not given: 3 ticks, at least "
         "0.1 s");
  parameters.back().minimum = 1e-3;  // 0 would always be too long ago
  number("max_age", "s", "1",
         "Data older than that stop the robot (needs the port pace); 0: never");
  parameters.push_back(
      {.name = "pipeline_ticks",
       .type = ParameterType::integer,
       .default_value = "0",
       .minimum = 0,
       .text = "Ticks that the data take longer than the pace, which waits for them"});
  const auto safety = safety_parameters();
  parameters.insert(parameters.end(), safety.begin(), safety.end());
  return parameters;
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
    const std::string text = fmt::format(
        "'command_rate' and 'command_update_rate' are two spellings of one key; leave out '{}'",
        other);
    if (strict) {
      throw ConfigurationError(parameters.where(other), text);
    }
    log::warning("{}, which {} ignores", text, program.name);
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
    const std::string text = fmt::format(
        "section '{}' has no message_mapping_filename, which says which channel goes to which "
        "field; write it, or message_type=FloatArray to send all channels",
        process.label());
    if (strict) {
      throw ConfigurationError(text);
    }
    log::warning("{}; a Float64MultiArray of all channels is sent", text);
  }
  return all_channels();
}

/// Of the first command of each message, in simulated time and ms.
void record_latency(music::Process& process, bool with_pace,
                    ros_command::CommandEndpoint& command) {
  if (auto write = with_pace ? process.value_recorder("latency", "ms") : nullptr) {
    command.on_latency([write = std::move(write)](TimeNs simulated, TimeNs latency) {
      write(simulated, static_cast<double>(latency) / 1e6);
    });
  }
}

}  // namespace

music::ProgramText command_text(const RosProgram& program) {
  music::ProgramText text;
  text.name = program.name;
  text.summary = "A continuous signal as command messages on a ROS topic";
  text.ports =
      "  in         input   continuous  the numbers to send\n"
      "  pace       input   continuous  [1] from ros_sensor_adapter: the age of the data\n";
  text.parameters = command_parameters(program);
  text.example = fmt::format(
      "  [command]\n  binary={}\n  np=1\n  ros_topic=/cmd_vel\n"
      "  message_mapping_filename=twist.json\n  SENDER.out -> command.in [2]\n"
      "\ntwist.json:\n"
      "  {{\"message_type\": \"Twist\", \"mapping\": {{\"linear.x\": 0, \"angular.z\": 1}},\n"
      "   \"min\": -1, \"max\": 1}}\n",
      program.name);
  text.notes =
      "A command that has moved by more than the deadband leaves at once. A zero command leaves "
      "when\n"
      "the run ends in whatever way, when no tick comes, when data are too old, and instead of a\n"
      "command with NaN or infinity in it. With SPIKELOOP_GUARD=PATH, spikeloop-guard sends it "
      "when\n"
      "this program cannot: killed by SIGKILL, or stopped by SIGSTOP. The topics emergency_stop "
      "and\n"
      "override are heard the moment a message comes. docs/safety.md has all of it.\n";
  return text;
}

int run_command(music::Process& process, const RosProgram& program) {
  process.declare_ports({"in", "pace"});
  const Parameters parameters = process.read(command_parameters(program));
  const std::string topic = required_topic(process, parameters, "/cmd_vel");
  const CommandMapping mapping = read_command_mapping(process, parameters);
  const std::uint32_t width = process.width("in");
  check_channels(mapping, width);
  const auto in = process.signal_input("in");
  // Delayed until the data of the same message are here: what it says is these data's age.
  const auto pace =
      process.connected_input("pace", PortKind::signal)
          ? process.signal_input("pace", static_cast<int>(parameters.integer("pipeline_ticks")))
          : nullptr;

  command::ComponentMap map = command::component_map(mapping, width);
  const auto& keys = process.common();
  command::CommandSettings settings = command::command_settings(
      parameters, map, command_rate(parameters, program, keys.strict),
      {keys.music_timestep, keys.rtf}, process.connected_input("pace", PortKind::signal));
  const session::Settings node = session_settings(parameters);
  add_safety(parameters, mapping, topic, node.ros, settings);
  if (process.checking()) {
    for (const CommandField& field : mapping.fields) {
      located_at(field.where, [&] {
        topics::Publisher::check(node.ros, topic, mapping.message_type, {field.field});
      });
    }
    topics::Publisher::check(node.ros, topic, mapping.message_type, command::field_paths(mapping));
    process.check();
    return 0;
  }
  const auto session = session::open(node);
  const NodeClass fields = command::command_map_class(std::move(map));
  ros_command::CommandEndpoint sink(
      *session, {process.label(), topic, mapping.message_type, command::field_paths(mapping)},
      settings);

  std::vector<std::unique_ptr<ros_command::Arrivals>> sensors;
  GraphDescription description;
  description.tick = process.common().music_timestep;
  description.seed = process.common().seed;
  description.sources = {{"in", in.get()}};
  description.nodes = {{"fields", &fields, {}, {}}};
  description.sinks = {{"topic", &sink}};
  description.connections = {{"in.in", "fields.in", width, 0, {}},
                             {"fields.out", "topic.command", settings.width, 0, {}}};
  if (pace) {
    description.sources.push_back({"pace", pace.get()});
    description.connections.push_back({"pace.pace", "topic.pace", 0, 0, {}});
  }
  for (const SensorTopic& topic_in : sensor_topics(parameters, node.ros)) {
    const std::size_t i = sensors.size();
    sensors.push_back(std::make_unique<ros_command::Arrivals>(*session, topic_in.sensor.topic,
                                                              topic_in.message_type));
    description.sources.push_back({fmt::format("sensor {}", i), sensors.back().get()});
    description.connections.push_back(
        {fmt::format("sensor {}.out", i), fmt::format("topic.sensor_{}", i), 1, 0, {}});
  }
  process.attach_recorders(description);
  record_latency(process, pace != nullptr, sink);
  Graph graph(description);
  music::Process::LoopHooks hooks;
  hooks.after_loop = [&] { sink.stop(command::StopReason::ended); };
  hooks.summary = [&] { return sink.summary(); };
  return process.run(graph, hooks);
}

}  // namespace spikeloop
