#include "spikeloop/experiment/node_types.hpp"
#include "spikeloop/core/code.hpp"

#include <algorithm>
#include <iterator>

#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/neurons/network.hpp"
#include "spikeloop/nodes/register.hpp"
#include "spikeloop/record/playback.hpp"
#include "spikeloop/sensing/event_keys.hpp"
#include "spikeloop/sensing/sensor_keys.hpp"

namespace spikeloop::experiment {
namespace {

using Parameter = ParameterDescription;

PortDescription out(PortKind kind, const char* text) {
  return {"out", kind, Direction::output, {}, text};
}

Parameter text(const char* name, std::optional<std::string> value, const char* line) {
  return {
      .name = name, .type = ParameterType::text, .default_value = std::move(value), .text = line};
}

/// One that must be given.
Parameter required(const char* name, const char* line, const char* example) {
  return {.name = name, .type = ParameterType::text, .text = line, .example = example};
}

Parameter number(const char* name, const char* unit, const char* value, double minimum,
                 const char* line) {
  return {.name = name, .unit = unit, .default_value = value, .minimum = minimum, .text = line};
}

NodeDescription ros_sensor() {
  NodeDescription sensor;
  sensor.name = kRosSensor;
  sensor.text = "The newest message of a topic as a continuous signal";
  sensor.source = "Weidel et al. 2016, section 2.2";
  sensor.ports = {out(PortKind::signal, "The message's numbers")};
  sensor.parameters = {
      required("topic", "Topic of the messages", "/scan"),
      required(
          "message",
          "Type of the messages: sensor_msgs/LaserScan, geometry_msgs/Twist, nav_msgs/Odometry, "
          "std_msgs/Float64MultiArray, sensor_msgs/Image; with fields any other, or the path "
          "of a .msg file",
          "sensor_msgs/LaserScan")};
  std::ranges::move(sensing::sensor_parameters(), std::back_inserter(sensor.parameters));
  sensor.parameters.push_back(
      text("initial", "none", "Value of every channel before the first message; none: silence"));
  sensor.parameters.push_back(number(
      "timeout", "s", "1 s", 0,
      "So long without a message that has a reading, and the robot is stopped; 0: never; not "
      "given: as sensor_timeout of the command says"));
  return sensor;
}

NodeDescription ros_event_sensor() {
  NodeDescription sensor;
  sensor.name = kRosEventSensor;
  sensor.text = "The events of a camera as spikes, each at its own time";
  sensor.ports = {out(PortKind::spikes, "A channel a pixel, or a block of pixels")};
  sensor.parameters = {required("topic", "Topic of the messages", "/dvs/events"),
                       required("message",
                                "Type of the messages: dvs_msgs/EventArray, or "
                                "event_camera_msgs/EventPacket, encoded as evt3, "
                                "evt2 or mono",
                                "dvs_msgs/EventArray")};
  std::ranges::move(sensing::event_parameters(), std::back_inserter(sensor.parameters));
  sensor.parameters.push_back(
      number("timeout", "s", "0", 0,
             "So long without a message, and the robot is stopped; 0: never, as a camera that sees "
             "nothing new may send nothing"));
  return sensor;
}

/// A map with the user's own keys, the paths of fields.
Parameter of_fields(const char* name, const char* line, Parameter each, const char* example) {
  each.name = kAnyKey;
  return {.name = name,
          .type = ParameterType::map,
          .default_value = "",
          .text = line,
          .inner = {std::move(each)},
          .example = example};
}

Parameter command_fields() {
  const auto channel = [](const char* name, const char* value, const char* line) {
    return Parameter{.name = name, .default_value = value, .text = line};
  };
  return of_fields("fields",
                   "Channel of each field, or a map of more; a Float64MultiArray without it has "
                   "all channels",
                   {.type = ParameterType::map,
                    .inner = {{.name = "channel",
                               .type = ParameterType::integer,
                               .minimum = 0,
                               .maximum = kMaximumChannels - 1,
                               .text = "Its number, from 0"},
                              channel("scale", "1", "Factor of the channel"),
                              channel("offset", "0", "What is added to it then"),
                              channel("min", "", "Least value of the field"),
                              channel("max", "", "Greatest value"),
                              channel("slew", "", "Fastest change, a second")},
                    .plain_key = "channel",
                    .example = "{channel: 1, scale: 0.5}"},
                   "{linear.x: 0, angular.z: 1}");
}

Parameter limits() {
  Parameter limits = of_fields(
      "limits",
      "Least and greatest values of fields; velocities of a Twist without them have [-1, 1] m/s "
      "and [-3, 3] rad/s; none: no field has any",
      {.type = ParameterType::list,
       .inner = {{.name = "end"}},
       .count = 2,
       .example = "[-0.5, 0.5]"},
      "{linear.x: [-0.5, 0.5]}");
  limits.choices = {kNoLimits};
  return limits;
}

Parameter slew() {
  return of_fields("slew", "Fastest change of fields, a second; of others any", {.minimum = 0},
                   "{linear.x: 1.0}");
}

NodeDescription ros_command() {
  NodeDescription command;
  command.name = kRosCommand;
  command.text = "A continuous signal as command messages, and a robot that is never left driving";
  command.source = "Weidel et al. 2016, section 2.2";
  command.ports = {{"in", PortKind::signal, Direction::input, {}, "The numbers to send"}};
  command.parameters = {
      required("topic", "Topic of the commands", "/cmd_vel"),
      required("message",
               "Type of the commands: geometry_msgs/Twist, std_msgs/Float64MultiArray, any other "
               "with fields, "
               "or the path of a .msg file",
               "geometry_msgs/Twist"),
      command_fields(),
      limits(),
      slew(),
      number("command_rate", "Hz", "20 Hz", 0,
             "Commands are sent again that often, times the real-time factor; 0: never"),
      number("deadband", "1", "0.01", 0,
             "Part of its range by which a field must move to be sent at once"),
      number(
          "min_interval", "s", "10 ms", 0,
          "Least time between two commands; not given: one tick, at least 10 ms; in lockstep 1 ms"),
      number("watchdog", "s", "100 ms", 1e-3,
             "Wall time without a tick after which a zero is sent; not given: 3 ticks, at least "
             "100 ms"),
      number("max_age", "s", "1 s", 0, "Data older than that stop the robot; 0: never"),
      number("sensor_timeout", "s", "1 s", 0,
             "A sensor on the way here that is silent for longer stops the robot; 0: never; not "
             "given: max_age"),
      number("spike_timeout", "s", "0", 0,
             "No spike on the way here for that long stops the robot; 0: a network may be silent"),
      emergency_stop_parameter(),
      override_parameter()};
  return command;
}

NodeDescription playback(const char* name, PortKind kind, const char* line) {
  NodeDescription result;
  result.name = name;
  result.text = line;
  result.ports = {out(kind, "What was recorded, at its own times")};
  result.parameters = record::playback_parameters();
  return result;
}

}  // namespace

NodeTypes::NodeTypes() {
  register_nodes(registry_);
  register_neurons(registry_);
  const auto add = [this](Role role, const NodeDescription& description) {
    endpoints_.emplace(description.name, Endpoint{role, NodeClass{description, {}}});
  };
  add(Role::source, ros_sensor());
  add(Role::source, ros_event_sensor());
  add(Role::sink, ros_command());
  add(Role::source, playback(kSpikePlayback, PortKind::spikes, "Recorded spikes once more"));
  add(Role::source,
      playback(kSignalPlayback, PortKind::signal, "A recorded continuous signal once more"));
}

void NodeTypes::load_plugin(const std::string& path) {
  for (const std::string& name : registry_.load_plugin(path)) {
    plugins_[name] = path;
  }
}

std::string NodeTypes::plugin_of(std::string_view name) const {
  const auto found = plugins_.find(name);
  return found == plugins_.end() ? "" : found->second;
}

bool NodeTypes::may_lack(std::string_view name) const {
  return incomplete_ && !endpoints_.contains(name) && !registry_.contains(name);
}

const NodeClass& NodeTypes::find(std::string_view name) const {
  if (const auto endpoint = endpoints_.find(name); endpoint != endpoints_.end()) {
    return endpoint->second.node_class;
  }
  if (registry_.contains(name)) {
    return registry_.find(name);
  }
  const std::string written(name);
  throw ConfigurationError(with_code(Code::unknown_class, "unknown node class '{}'{}", written,
                                     did_you_mean(written, names())));
}

Role NodeTypes::role(std::string_view name) const {
  const auto endpoint = endpoints_.find(name);
  return endpoint == endpoints_.end() ? Role::node : endpoint->second.role;
}

std::vector<std::string> NodeTypes::endpoints() const {
  std::vector<std::string> names;
  for (const auto& [name, endpoint] : endpoints_) {
    names.push_back(name);
  }
  return names;
}

std::vector<std::string> NodeTypes::names() const {
  std::vector<std::string> names = registry_.names();
  const auto more = endpoints();
  names.insert(names.end(), more.begin(), more.end());
  std::ranges::sort(names);
  return names;
}

}  // namespace spikeloop::experiment
