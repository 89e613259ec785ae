// ros_sensor_adapter: the newest message of a topic as a continuous signal.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "programs.hpp"
#include "spikeloop/command/watch.hpp"
#include "spikeloop/config/message_type.hpp"
#include "spikeloop/config/sensor_mapping_file.hpp"
#include "spikeloop/process/initial_key.hpp"
#include "spikeloop/sensing/sensor_keys.hpp"
#include "spikeloop/topics/sensor.hpp"

namespace spikeloop {
namespace {

std::vector<ParameterDescription> sensor_parameters(const RosProgram& program) {
  auto parameters = connection_parameters(program);
  parameters.push_back(
      {.name = "message_type",
       .type = ParameterType::text,
       .default_value = "",
       .text =
           "Laserscan, Twist, FloatArray, Odom, package/Type or the path of a .msg file; must be "
           "given"});
  parameters.push_back(
      {.name = "fields",
       .type = ParameterType::text,
       .default_value = "",
       .text = "Other fields than the type's usual ones, as PATH,PATH,...: their numbers as they "
               "are"});
  parameters.push_back(
      {.name = "sensor_mapping_filename",
       .type = ParameterType::text,
       .default_value = "",
       .text = "File with fields and their scales and limits, or with what is taken of a picture"});
  parameters.push_back(music::initial_parameter());
  parameters.push_back({.name = "sensor_update_rate",
                        .unit = "Hz",
                        .default_value = "30",
                        .minimum = 0,
                        .text = "Accepted for older files; messages are taken when they arrive"});
  return parameters;
}

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts;
  std::istringstream stream(list);
  for (std::string part; std::getline(stream, part, ',');) {
    const auto first = part.find_first_not_of(' ');
    const auto last = part.find_last_not_of(' ');
    parts.push_back(first == std::string::npos ? "" : part.substr(first, last - first + 1));
  }
  return parts;
}

std::string message_type(const music::Process& process, const Parameters& parameters) {
  const std::string& text = parameters.text("message_type");
  const Location& where = parameters.where("message_type");
  if (text.empty()) {
    throw ConfigurationError(where,
                             "message_type is missing; write message_type=Laserscan, Twist, "
                             "FloatArray, Odom, package/Type or the path of a .msg file");
  }
  const bool told =
      !parameters.text("fields").empty() || parameters.given("sensor_mapping_filename");
  if (told && text.find_first_of("/.") == std::string::npos) {
    return text;  // any type that has a definition
  }
  return located_at(where, [&] { return canonical_message_type(text, process.file_directory()); });
}

messages::SensorRule sensor_rule(const music::Process& process, const Parameters& parameters) {
  const std::string& file = parameters.text("sensor_mapping_filename");
  const std::string& fields = parameters.text("fields");
  if (file.empty()) {
    return messages::plain_fields(fields.empty() ? std::vector<std::string>{} : split(fields));
  }
  const Location& where = parameters.where("sensor_mapping_filename");
  if (!fields.empty()) {
    throw ConfigurationError(
        where,
        "'fields' and 'sensor_mapping_filename' both say what to take; leave one of them out");
  }
  const WrittenValues keys =
      located_at(where, [&] { return read_sensor_mapping(file, process.file_directory()); });
  return sensing::sensor_rule(resolve(sensing::sensor_parameters(), keys, {}));
}

/// Where what is taken was written.
Location rule_place(const music::Process& process, const Parameters& parameters) {
  for (const char* key : {"fields", "sensor_mapping_filename"}) {
    if (!parameters.text(key).empty()) {
      return parameters.where(key);
    }
  }
  return process.where("out");
}

}  // namespace

music::ProgramText sensor_text(const RosProgram& program) {
  music::ProgramText text;
  text.name = program.name;
  text.summary = "The newest message of a ROS topic as a continuous signal";
  text.ports =
      "  out        output  continuous  the message's numbers\n"
      "  pace       output  continuous  [1] when the newest message came (monotonic clock, s)\n";
  text.parameters = sensor_parameters(program);
  text.example = fmt::format(
      "  [sensor]\n  binary={}\n  np=1\n  ros_topic=/scan\n"
      "  message_type=Laserscan\n  sensor.out -> RECEIVER.in [100]\n",
      program.name);
  text.notes =
      "LaserScan: 2 (r - range_min) / (range_max - range_min) - 1; nearer than range_min and -inf\n"
      "are -1, beyond range_max and +inf are 1; NaN and 0 are no reading, the beam keeps its "
      "value.\n"
      "Twist: linear.x and angular.z, limited to [-1, 1]. Float64MultiArray: as it is. Odometry:\n"
      "x[, y[, z]] in metres. Image, CompressedImage: grey, -1 to 1.\n"
      "A mapping file holds  {\"fields\": [\"PATH\", {\"path\": \"PATH\", \"scale\": 2}]}  or\n"
      "{\"image\": {\"resize\": [40, 30]}}  (docs/images.md).\n";
  text.defaults.pace = true;
  return text;
}

int run_sensor(music::Process& process, const RosProgram& program) {
  command::Watch::release_signals();
  process.set_defaults({.pace = true, .accept_one_tick = false});
  process.declare_ports({"out", "pace"});
  const Parameters parameters = process.read(sensor_parameters(program));
  topics::SensorSettings settings;
  settings.topic = required_topic(process, parameters, "/scan");
  settings.message_type = message_type(process, parameters);
  settings.rule = sensor_rule(process, parameters);
  settings.width = process.width("out");
  settings.strict = process.common().strict;
  settings.initial = music::initial_value(parameters);

  const auto out = process.signal_output("out");
  const auto pace =
      process.connected_output("pace", PortKind::signal) ? process.signal_output("pace") : nullptr;
  const session::Settings node = session_settings(parameters);
  if (process.checking()) {
    located_at(rule_place(process, parameters), [&] { topics::Sensor::check(node.ros, settings); });
    process.check();
    return 0;
  }
  const auto session = session::open(node);
  topics::Sensor sensor(*session, settings);

  GraphDescription more;
  if (pace) {
    more.sinks.push_back({"pace", pace.get()});
    more.connections.push_back({"topic.pace", "pace.pace", 0, 0, {}});
  }
  music::Process::LoopHooks hooks;
  hooks.summary = [&] { return nlohmann::json{{"scans", sensor.counters().front().value}}; };
  return run_topic(process, {settings.topic, node.ros}, sensor, *out, std::move(more),
                   std::move(hooks));
}

}  // namespace spikeloop
