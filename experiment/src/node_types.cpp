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

Parameter flag(const char* name, const char* line) {
  return {.name = name, .type = ParameterType::boolean, .default_value = "false", .text = line};
}

NodeDescription ros_sensor() {
  NodeDescription sensor;
  sensor.name = kRosSensor;
  sensor.text = "Converts the newest message of a topic to a continuous signal";
  sensor.source = "Weidel et al. 2016, section 2.2";
  sensor.ports = {out(PortKind::signal, "Numbers of the message")};
  sensor.parameters = {required("topic", "Topic to subscribe to", "/scan"),
                       required("message",
                                "Message type: sensor_msgs/LaserScan, geometry_msgs/Twist, "
                                "nav_msgs/Odometry, std_msgs/Float64MultiArray, sensor_msgs/Image; "
                                "with fields, any other type or the path of a .msg file",
                                "sensor_msgs/LaserScan")};
  std::ranges::move(sensing::sensor_parameters(), std::back_inserter(sensor.parameters));
  sensor.parameters.push_back(text(
      "initial", "none", "Value of every channel before its first valid value; none: no value"));
  sensor.parameters.push_back(
      number("timeout", "s", "1 s", 0,
             "Time without a message with a valid reading after which the robot is stopped; 0: "
             "never; not given: sensor_timeout of the command"));
  return sensor;
}

NodeDescription ros_event_sensor() {
  NodeDescription sensor;
  sensor.name = kRosEventSensor;
  sensor.text = "Converts the events of an event camera to spikes, each at its own time";
  sensor.ports = {out(PortKind::spikes, "One channel per pixel or block of pixels")};
  sensor.parameters = {
      required("topic", "Topic to subscribe to", "/dvs/events"),
      required("message",
               "Message type: dvs_msgs/EventArray, or event_camera_msgs/EventPacket with the "
               "encoding evt3, evt2 or mono",
               "dvs_msgs/EventArray")};
  std::ranges::move(sensing::event_parameters(), std::back_inserter(sensor.parameters));
  sensor.parameters.push_back(number("timeout", "s", "0", 0,
                                     "Time without a message after which the robot is stopped; 0: "
                                     "never (a camera may send nothing while nothing changes)"));
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
                   "Channel of each field, or a map of further keys; without it, a "
                   "Float64MultiArray has all channels",
                   {.type = ParameterType::map,
                    .inner = {{.name = "channel",
                               .type = ParameterType::integer,
                               .minimum = 0,
                               .maximum = kMaximumChannels - 1,
                               .text = "Channel number, from 0"},
                              channel("scale", "1", "Factor applied to the channel"),
                              channel("offset", "0", "Added after the factor"),
                              channel("min", "", "Minimum of the field"),
                              channel("max", "", "Maximum of the field"),
                              channel("slew", "", "Largest change per second"),
                              {.name = "stop",
                               .type = ParameterType::text,
                               .default_value = "",
                               .text = "Value at a stop, as in the key stop"}},
                    .plain_key = "channel",
                    .example = "{channel: 1, scale: 0.5}"},
                   "{linear.x: 0, angular.z: 1}");
}

Parameter limits() {
  Parameter limits = of_fields("limits",
                               "Minimum and maximum of fields; default for velocities of a Twist: "
                               "[-1, 1] m/s and [-3, 3] rad/s; none: no limits",
                               {.type = ParameterType::list,
                                .inner = {{.name = "end"}},
                                .count = 2,
                                .example = "[-0.5, 0.5]"},
                               "{linear.x: [-0.5, 0.5]}");
  limits.choices = {kNoLimits};
  return limits;
}

Parameter slew() {
  return of_fields("slew", "Largest change of fields per second; other fields: no limit",
                   {.minimum = 0}, "{linear.x: 1.0}");
}

Parameter stop() {
  Parameter stop = of_fields(
      "stop",
      "Value of fields while the robot is stopped: a number, hold (the last position), or hold "
      "NAME "
      "(the measured position of joint NAME); or zero or hold for all fields; not given: positions "
      "are held, other fields are 0",
      {.type = ParameterType::text}, "{FIELD: 0}");
  stop.choices = {"zero", "hold"};
  return stop;
}

NodeDescription ros_command() {
  NodeDescription command;
  command.name = kRosCommand;
  command.text =
      "Sends a continuous signal as command messages; stops the robot when data are missing or the "
      "run ends";
  command.source = "Weidel et al. 2016, section 2.2";
  command.ports = {{"in", PortKind::signal, Direction::input, {}, "Numbers to send"}};
  command.parameters = {
      required("topic", "Topic to publish to", "/cmd_vel"),
      required("message",
               "Message type: geometry_msgs/Twist, std_msgs/Float64MultiArray; with fields, any "
               "other type or the path of a .msg file",
               "geometry_msgs/Twist"),
      command_fields(),
      limits(),
      slew(),
      stop(),
      {.name = "joint_states",
       .type = ParameterType::text,
       .default_value = "",
       .text =
           "Topic of sensor_msgs/JointState with the positions that a stop holds; not given: that "
           "of an upstream sensor, else joint_states in the namespace of topic; none: a stop "
           "holds the last command"},
      number("command_rate", "Hz", "20 Hz", 0,
             "Rate at which commands are repeated, multiplied by the real-time factor; 0: never"),
      number("deadband", "1", "0.01", 0,
             "Change of a field, as a fraction of its range, that is sent immediately"),
      number(
          "min_interval", "s", "10 ms", 0,
          "Shortest time between two changes of the command; not given: one tick, at least 10 ms; "
          "in lockstep 1 ms"),
      number("watchdog", "s", "100 ms", 1e-3,
             "Wall time without a tick after which a stop command is sent; not given: 3 ticks, at "
             "least 100 ms"),
      number("max_age", "s", "1 s", 0,
             "Age of the data above which the robot is stopped; 0: never"),
      number("sensor_timeout", "s", "1 s", 0,
             "Time without a message from an upstream sensor after which the robot is stopped; 0: "
             "never; not given: max_age"),
      number("spike_timeout", "s", "0", 0,
             "Time without an upstream spike after which the robot is stopped; 0: never"),
      emergency_stop_parameter(),
      override_parameter(),
      flag("guard_required",
           "The robot is stopped while no guard answers; over ROS, not in lockstep")};
  return command;
}

NodeDescription playback(const char* name, PortKind kind, const char* line) {
  NodeDescription result;
  result.name = name;
  result.text = line;
  result.ports = {out(kind, "Recorded data, at the recorded times")};
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
  add(Role::source, playback(kSpikePlayback, PortKind::spikes, "Plays back recorded spikes"));
  add(Role::source,
      playback(kSignalPlayback, PortKind::signal, "Plays back a recorded continuous signal"));
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
