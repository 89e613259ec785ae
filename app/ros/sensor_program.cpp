// ros_sensor_adapter: the newest message of a topic as a continuous signal.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "programs.hpp"
#include "spikeloop/command/watch.hpp"
#include "spikeloop/config/sensor_mapping_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/sensing/sensor_keys.hpp"
#include "spikeloop/status/deadline.hpp"
#include "spikeloop/status/signals.hpp"
#include "spikeloop/topics/rosout.hpp"
#include "spikeloop/topics/sensor.hpp"

namespace spikeloop {
namespace {

constexpr const char* kMapping = "sensor_mapping_filename";

std::vector<ParameterDescription> sensor_parameters(const RosProgram& program) {
  return program_parameters(
      program,
      {{.name = kMapping,
        .type = ParameterType::text,
        .default_value = "",
        .text = "File with fields, their scales and limits, or with the settings of an image"},
       update_rate_parameter()});
}

/// The file has the keys `fields` and `image` of the node.
void read_mapping_file(const music::Process& process, const Parameters& keys,
                       experiment::Node& sensor) {
  const std::string& file = keys.text(kMapping);
  if (file.empty()) {
    return;
  }
  const Location& where = keys.where(kMapping);
  if (keys.given("fields")) {
    throw ConfigurationError(
        where,
        with_code(
            Code::conflicting_keys,
            "'fields' and 'sensor_mapping_filename' both say what to take; leave one of them out"));
  }
  const WrittenValues written =
      located_at(where, [&] { return read_sensor_mapping(file, process.file_directory()); });
  const Parameters read = resolve(sensing::sensor_parameters(), written, {});
  for (const auto& [name, value] : read.all()) {
    if (read.given(name)) {
      sensor.parameters.set(name, value, true, read.where(name));
    }
  }
}

/// Where what is taken was written.
Location rule_place(const music::Process& process, const Parameters& parameters) {
  for (const char* key : {"fields", kMapping, "beams", "angles", "range"}) {
    if (parameters.given(key)) {
      return parameters.where(key);
    }
  }
  return process.where("out");
}

}  // namespace

music::ProgramText sensor_text(const RosProgram& program) {
  music::ProgramText text;
  text.name = program.name;
  text.summary = "Converts the newest ROS message to a continuous signal";
  text.ports =
      "  out        output  continuous  Numbers of the message\n"
      "  data_stamp output  continuous  [1] Arrival of the newest message (monotonic clock, s)\n";
  text.parameters = sensor_parameters(program);
  text.example = fmt::format(
      "  [sensor]\n  binary={}\n  np=1\n  ros_topic=/scan\n"
      "  message_type=Laserscan\n  sensor.out -> RECEIVER.in [100]\n",
      program.name);
  text.notes =
      "LaserScan: 2 (r - range_min) / (range_max - range_min) - 1; below range_min and -inf: -1;\n"
      "above range_max and +inf: 1; NaN and 0 are no reading, the beam keeps its value.\n"
      "Channel 0 is the rightmost beam. beams=100, angles=-90,90 resample scans to 100 angles;\n"
      "range=0,10 replaces range_min and range_max.\n"
      "Twist: linear.x and angular.z, limited to [-1, 1]. Float64MultiArray: unchanged. Odometry:\n"
      "x[, y[, z]] in metres. Image, CompressedImage: grey, -1 to 1.\n"
      "Older names of types: Laserscan, Twist, FloatArray, Odom.\n"
      "fields=PATH,PATH selects other fields; their numbers are not scaled.\n"
      "A mapping file contains  {\"fields\": [\"PATH\", {\"path\": \"PATH\", \"scale\": 2}]}  or\n"
      "{\"image\": {\"resize\": [40, 30]}}  (docs/images.md).\n";
  text.defaults.clock_master = true;
  return text;
}

int run_sensor(music::Process& process, const RosProgram& program) {
  command::Watch::release_signals();
  process.set_defaults({.clock_master = true, .accept_one_tick = false});
  process.declare_ports({"out", "data_stamp"});
  Section section = read_section(process, program, sensor_parameters(program));
  read_mapping_file(process, section.keys, section.node);
  experiment::read_endpoint(section.node, process.file_directory(), section.ros.ros);
  topics::SensorSettings settings = experiment::sensor_settings(section.node.parameters);
  settings.width = process.width("out");
  settings.strict = process.common().strict;

  const auto out = process.signal_output("out");
  const auto data_stamp = process.connected_output("data_stamp", PortKind::signal)
                              ? process.signal_output("data_stamp")
                              : nullptr;
  if (process.checking()) {
    located_at(rule_place(process, section.keys),
               [&] { topics::Sensor::check(section.ros.ros, settings); });
    process.check();
    return 0;
  }
  const auto session = session::open(section.ros);
  const status::TerminationHook on_termination([&] { session->leave(); });  // the last of all
  topics::Rosout rosout(*session);
  topics::Sensor sensor(*session, settings);

  GraphDescription more;
  if (data_stamp) {
    more.sinks.push_back({"data_stamp", data_stamp.get()});
    more.connections.push_back({"topic.data_stamp", "data_stamp.data_stamp", 0, 0, {}});
  }
  music::Process::LoopHooks hooks;
  hooks.summary = [&] { return nlohmann::json{{"scans", sensor.counters().front().value}}; };
  return status::end_in_time(rosout.during([&] {
    return run_topic(process, section, sensor, *out, std::move(more), std::move(hooks));
  }));
}

}  // namespace spikeloop
