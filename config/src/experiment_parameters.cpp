// The keys of experiment files, as data.
#include "spikeloop/config/experiment_file.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/core/write_failures.hpp"

namespace spikeloop {

std::vector<ParameterDescription> experiment_parameters() {
  return {
      {.name = "experiment",
       .type = ParameterType::text,
       .default_value = "",
       .text = "Name of the experiment; not given: name of the file"},
      {.name = "duration",
       .unit = "s",
       .default_value = "",
       .minimum = 0,
       .maximum = 9e9,
       .text = "Simulated time, a whole number of ticks; not given: the experiment runs until it "
               "is stopped"},
      {.name = "tick",
       .unit = "s",
       .default_value = "1 ms",
       .minimum = 1e-9,
       .maximum = 1000,
       .text = "Interval at which sensors, network and commands exchange data"},
      {.name = "seed",
       .type = ParameterType::integer,
       .default_value = "1",
       .minimum = 0,
       .text = "Seed of all random numbers, combined with the node's name"},
      {.name = "sync",
       .type = ParameterType::choice,
       .default_value = "realtime",
       .choices = {"realtime", "unpaced", "lockstep", "sim_time"},
       .text =
           "What simulated time waits for. realtime: the wall clock; unpaced: nothing; lockstep: "
           "the robot simulator, tick by tick; sim_time: the topic /clock (ros: 1 or 2)"},
      {.name = "real_time_factor",
       .unit = "1",
       .default_value = "1",
       .minimum = 0.001,
       .maximum = 1000,
       .text = "Ratio of simulated time to wall time, with sync: realtime"},
      {.name = kOnWriteFailureKey,
       .type = ParameterType::choice,
       .default_value = "stop",
       .choices = on_write_failure_choices(),
       .text = "Reaction to a file that cannot be written (full disk, deleted run folder). stop: "
               "stop the robot and end the run; continue: print a warning and continue without the "
               "file"},
      {.name = "ros",
       .type = ParameterType::choice,
       .default_value = "none",
       .choices = {"none", "1", "2"},
       .text = "ROS version for messages; none: messages stay in memory, between this process and "
               "its own robot"},
      {.name = "layout",
       .type = ParameterType::map,
       .default_value = "fused",
       .choices = {"fused", "separate"},
       .text = "Which nodes share a process: fused (all), separate (none), or a map from process "
               "names to lists of nodes; simulators always run in separate processes",
       .inner = {{.name = kAnyKey,
                  .type = ParameterType::list,
                  .inner = {{.name = "node", .type = ParameterType::text}},
                  .example = "[encoder, decoder]"}},
       .example = "{vision: [camera], control: [encoder, decoder, wheels]}"},
      {.name = "episodes",
       .type = ParameterType::map,
       .default_value = "",
       .text = "Episodes of a task: when they end, what is between them, what reward is sent; not "
               "given: an environment has its own, any other robot has none",
       .inner = episode_parameters(),
       .example = "{count: 50, pause: 400 ms}"},
  };
}

std::vector<ParameterDescription> episode_parameters() {
  const auto reward = [](const char* name, const char* text) {
    return ParameterDescription{.name = name, .unit = "1", .default_value = "", .text = text};
  };
  return {{.name = "count",
           .type = ParameterType::integer,
           .default_value = "",
           .minimum = 1,
           .text = "Number of episodes after which the run ends; not given: no limit"},
          {.name = "time_limit",
           .unit = "s",
           .default_value = "",
           .minimum = 1e-9,
           .maximum = 9e9,
           .text = "Simulated time after which an episode ends; not given: the limit of the "
                   "environment, no limit for any other robot"},
          {.name = "hold",
           .unit = "s",
           .default_value = "0",
           .minimum = 0,
           .maximum = 9e9,
           .text = "Simulated time for which the last observation and reward of an episode are "
                   "sent, at least one step"},
          {.name = "pause",
           .unit = "s",
           .default_value = "0",
           .minimum = 0,
           .maximum = 9e9,
           .text = "Simulated time after that, before the next episode; the robot does not move"},
          reward("pause_observation",
                 "Value of all numbers of an observation in a pause, e.g. 9999, so that no place "
                 "cell is active; not given: the last observation"),
          {.name = "reset",
           .type = ParameterType::list,
           .default_value = "",
           .choices = {"all"},
           .text = "Nodes that begin every episode in their first state; networks keep the weights "
                   "that they have learned. all: all nodes that can; not given: none",
           .inner = {{.name = "node", .type = ParameterType::text}},
           .example = "[encoder, brain]"},
          reward("begin_reward",
                 "Reward that is sent in the pause and before the first step; not given: 0"),
          reward("end_reward",
                 "Reward that is sent with the last observation of an episode; not given: that of "
                 "the last step"),
          reward("failure_reward", "The same, only if the reward of the last step is 0"),
          reward("collision_reward",
                 "Reward of a step in which the vehicle collides, and which ends the episode; not "
                 "given: the episode goes on"),
          {.name = "goal",
           .type = ParameterType::text,
           .default_value = "",
           .text = "The goal_* of the vehicle's world that has the reward 1, any other -1; not "
                   "given: that of the cue's place"}};
}

std::vector<ParameterDescription> robot_parameters() {
  return {{.name = "simulator",
           .type = ParameterType::choice,
           .default_value = "",
           .choices = {"mujoco"},
           .text = "Simulator of the robot"},
          {.name = "environment",
           .type = ParameterType::text,
           .default_value = "",
           .text = "Environment of reinforcement learning, which replaces the robot: "
                   "cart_pole, frozen_lake, mountain_car or water_maze; FILE.py:FUNCTION or "
                   "gymnasium:NAME for one in Python"},
          {.name = "step",
           .unit = "s",
           .default_value = "",
           .minimum = 1e-9,
           .maximum = 1000,
           .text = "Simulated time of a step of the environment, a whole number of ticks; not "
                   "given: its own"},
          {.name = "slippery",
           .type = ParameterType::boolean,
           .default_value = "false",
           .text = "frozen_lake: two of three moves go to the side"},
          {.name = "world",
           .type = ParameterType::text,
           .default_value = "arena.xml",
           .text = "World of the vehicle: MJCF file, or name of a shipped one"},
          {.name = "model",
           .type = ParameterType::text,
           .default_value = "",
           .text = "MJCF file of any other robot, which replaces vehicle and world"},
          {.name = "keyframe",
           .type = ParameterType::text,
           .default_value = "",
           .text = "Keyframe of the model to start from; not given: the positions of the file"},
          {.name = "rate",
           .unit = "Hz",
           .default_value = "100 Hz",
           .minimum = 0.001,
           .maximum = 1000,
           .text = "Messages of the model per simulated second: joint states and sensors"},
          {.name = "seed",
           .type = ParameterType::integer,
           .default_value = "",
           .minimum = 0,
           .text = "Seed of obstacle positions and start states; not given: seed of the "
                   "experiment"},
          {.name = "camera",
           .type = ParameterType::map,
           .default_value = "",
           .text = "Camera that publishes images on /camera/image_raw: {width: 64, height: 48, "
                   "rate: 20 Hz, fov: 80 deg}; not given: off",
           .inner = camera_parameters(),
           .example = "{width: 64, height: 48}"},
          {.name = "bag",
           .type = ParameterType::text,
           .default_value = "",
           .text = "Recording that replaces the robot, without other keys: MCAP, SQLite or ROS 1 "
                   "bag, or the folder of its parts; sensors receive the messages of their topics "
                   "from it"}};
}

std::vector<ParameterDescription> camera_parameters() {
  return {{.name = "name",
           .type = ParameterType::text,
           .default_value = "camera",
           .text = "Name of the camera in the MJCF file"},
          {.name = "width",
           .type = ParameterType::integer,
           .default_value = "64",
           .minimum = 1,
           .maximum = 4096,
           .text = "Image width in pixels"},
          {.name = "height",
           .type = ParameterType::integer,
           .default_value = "48",
           .minimum = 1,
           .maximum = 4096,
           .text = "Image height in pixels"},
          {.name = "rate",
           .unit = "Hz",
           .default_value = "20 Hz",
           .minimum = 0.001,
           .maximum = 1000,
           .text = "Images per simulated second"},
          {.name = "fov",
           .unit = "deg",
           .default_value = "80 deg",
           .minimum = 1,
           .maximum = 170,
           .text = "Horizontal field of view"}};
}

std::vector<ParameterDescription> connection_parameters() {
  return {
      {.name = "from",
       .type = ParameterType::text,
       .text =
           "Sender: NODE or NODE.PORT; some of its channels: \"a[0:50]\"; several senders: [a, b] "
           "with channels one after another, a + b for the sum"},
      {.name = "to", .type = ParameterType::text, .text = "Receiver: NODE or NODE.PORT"},
      {.name = "width",
       .type = ParameterType::integer,
       .default_value = "",
       .minimum = 1,
       .maximum = kMaximumChannels,
       .text = "Number of channels; not given: derived from the nodes and other connections"},
      {.name = "delay",
       .type = ParameterType::text,
       .default_value = "",
       .text = "Time or number of ticks: 5 ms, 2 ticks; a cycle needs a delay"}};
}

std::vector<ParameterDescription> node_parameters() {
  return {{.name = "record",
           .type = ParameterType::boolean,
           .default_value = "true",
           .text = "false: the outputs of the node are not written to the run folder"}};
}

}  // namespace spikeloop
