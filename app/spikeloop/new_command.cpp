#include "commands.hpp"

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "option_values.hpp"
#include "output.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::app::new_command {
namespace {

/// Runs as it is: nothing else is needed, no ROS, no other file.
constexpr const char* kExperiment =
    R"(# A vehicle that explores an arena, steered by ten spiking neurons.
#
#   spikeloop check NAME.yaml     reports errors in this file
#   spikeloop run NAME.yaml       runs it and writes the results to runs/NAME-1
#   spikeloop graph NAME.yaml --out NAME.svg      draws it
#
# `spikeloop describe` lists the node classes, `spikeloop describe CLASS` their parameters.
experiment: NAME
duration: 5 s        # simulated time; without this line, until Ctrl-C
tick: 1 ms           # interval at which sensors, network and commands exchange data
seed: 1              # of all random numbers
sync: realtime       # or lockstep: as fast as possible; repeated runs are bit-identical

# The robot is simulated in this process. To use any ROS robot, write  ros: 1  or  ros: 2  in place
# of this line.
robot: {simulator: mujoco, world: arena.xml}

nodes:
  # 100 laser beams from right to left: -1 is near, 1 is far.
  scan: {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}
  # Each channel is the mean of ten neighbouring beams.
  sectors: {node: connect, weights: blocks}
  # One neuron per sector; its rate increases with the distance of the obstacles.
  encoder: {node: rate_encoder, rate_min: 1 Hz, rate_max: 200 Hz}
  # The network can also be in a separate file:  network: brain.yaml
  brain:
    simulator: builtin
    network:
      populations:
        input: {model: input, size: 10}
        relay: {model: repeater, size: 10}
      connections:
        - {from: input, to: relay, rule: one_to_one, delay: 1 ms}
      output: [relay]
  # Speed and turning rate: weighted sums of the firing rates.
  decoder:
    node: linear_readout
    tau: 30 ms
    weights:
      - [-0.0026, -0.0006, -0.0001, 0.0020, 0.0042, 0.0042, 0.0020, -0.0001, -0.0006, -0.0026]
      - [0.0021, -0.0031, -0.0047, -0.0053, -0.0052, -0.0001, 0.0043, 0.0045, 0.0015, 0.0008]
  wheels:
    node: ros_command
    topic: /cmd_vel
    message: geometry_msgs/Twist
    fields:
      linear.x: {channel: 0}                  # m/s
      angular.z: {channel: 1, offset: 0.2}    # rad/s, positive: left
    limits: {linear.x: [0, 0.8], angular.z: [-2.2, 1.7]}

connections:
  # NODE -> NODE [width]; with a delay: [10, delay 5 ms].
  - scan -> sectors [100] -> encoder [10] -> brain [10] -> decoder [10] -> wheels [2]
)";

constexpr const char* kFooter = R"(Examples:
  spikeloop new > explorer.yaml && spikeloop run explorer.yaml
  spikeloop new maze > maze.yaml         the same with another name)";

std::string named_experiment(const std::string& name) {
  constexpr std::string_view kPlace = "NAME";
  std::string text = kExperiment;
  for (auto at = text.find(kPlace); at != std::string::npos; at = text.find(kPlace, at)) {
    text.replace(at, kPlace.size(), name);
    at += name.size();
  }
  return text;
}

int print_new(const std::string& name) {
  const std::string allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  if (name.find_first_not_of(allowed) != std::string::npos) {
    throw ConfigurationError(
        "'" + name + "' is not a valid experiment name; write letters, digits, '_' and '-'");
  }
  put_result(named_experiment(name));
  return 0;
}

}  // namespace

void add(CLI::App& app, Action& action) {
  const auto name = std::make_shared<std::string>("explorer");
  CLI::App* command =
      app.add_subcommand("new", "Print a commented experiment file that is ready to run");
  command->add_option("NAME", *name, "Name of the experiment")->check(named("experiment"));
  command->footer(kFooter);
  command->callback([name, &action] { action = [name] { return print_new(*name); }; });
}

}  // namespace spikeloop::app::new_command
