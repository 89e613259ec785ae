// The keys of experiment files, as data.
#include "spikeloop/config/experiment_file.hpp"
#include "spikeloop/config/weight_file.hpp"

namespace spikeloop {

std::vector<ParameterDescription> experiment_parameters() {
  return {
      {.name = "experiment",
       .type = ParameterType::text,
       .default_value = "",
       .text = "Its name; that of the file when it is left out"},
      {.name = "duration",
       .unit = "s",
       .default_value = "",
       .minimum = 0,
       .maximum = 9e9,
       .text =
           "Simulated time, a whole number of ticks; without it, the experiment runs until it is "
           "stopped"},
      {.name = "tick",
       .unit = "s",
       .default_value = "1 ms",
       .minimum = 1e-9,
       .maximum = 1000,
       .text = "How often sensors, network and commands exchange their data"},
      {.name = "seed",
       .type = ParameterType::integer,
       .default_value = "1",
       .minimum = 0,
       .text = "Seed of all random numbers, with the node's name"},
      {.name = "sync",
       .type = ParameterType::choice,
       .default_value = "realtime",
       .choices = {"realtime", "unpaced", "lockstep", "sim_time"},
       .text =
           "What simulated time waits for: the wall clock, nothing, the robot simulator tick by "
           "tick, the topic /clock (ros: 1 or 2)"},
      {.name = "real_time_factor",
       .unit = "1",
       .default_value = "1",
       .minimum = 0.001,
       .maximum = 1000,
       .text = "Simulated time over wall time, with sync: realtime"},
      {.name = "ros",
       .type = ParameterType::choice,
       .default_value = "none",
       .choices = {"none", "1", "2"},
       .text = "What carries messages; none: memory, between this process and its own robot"},
      {.name = "layout",
       .type = ParameterType::map,
       .default_value = "fused",
       .choices = {"fused", "separate"},
       .text =
           "Which nodes share a process: fused (all of them), separate (none), or a map from names "
           "of processes to lists of nodes; simulators have processes of their own",
       .inner = {{.name = kAnyKey,
                  .type = ParameterType::list,
                  .inner = {{.name = "node", .type = ParameterType::text}},
                  .example = "[encoder, decoder]"}},
       .example = "{vision: [camera], control: [encoder, decoder, wheels]}"},
  };
}

std::vector<ParameterDescription> robot_parameters() {
  return {
      {.name = "simulator",
       .type = ParameterType::choice,
       .default_value = "",
       .choices = {"mujoco"},
       .text = "What simulates the robot"},
      {.name = "world",
       .type = ParameterType::text,
       .default_value = "arena.xml",
       .text = "An MJCF file, or the name of a shipped world"},
      {.name = "seed",
       .type = ParameterType::integer,
       .default_value = "",
       .minimum = 0,
       .text = "Places the obstacles; the experiment's when it is left out"},
      {.name = "camera",
       .type = ParameterType::map,
       .default_value = "",
       .text =
           "Its pictures on /camera/image_raw: {width: 64, height: 48, rate: 20 Hz, fov: 80 deg}; "
           "off when it is left out",
       .inner = camera_parameters(),
       .example = "{width: 64, height: 48}"},
      {.name = "bag",
       .type = ParameterType::text,
       .default_value = "",
       .text = "A bag of ROS 1 in the robot's place, alone: sensors take their topics' messages "
               "from it"}};
}

std::vector<ParameterDescription> camera_parameters() {
  return {{.name = "width",
           .type = ParameterType::integer,
           .default_value = "64",
           .minimum = 1,
           .maximum = 4096,
           .text = "Pixels from left to right"},
          {.name = "height",
           .type = ParameterType::integer,
           .default_value = "48",
           .minimum = 1,
           .maximum = 4096,
           .text = "Pixels from top to bottom"},
          {.name = "rate",
           .unit = "Hz",
           .default_value = "20 Hz",
           .minimum = 0.001,
           .maximum = 1000,
           .text = "Pictures in a simulated second"},
          {.name = "fov",
           .unit = "deg",
           .default_value = "80 deg",
           .minimum = 1,
           .maximum = 170,
           .text = "Field of view, from the left edge to the right one"}};
}

std::vector<ParameterDescription> connection_parameters() {
  return {{.name = "from", .type = ParameterType::text, .text = "NODE or NODE.PORT that sends"},
          {.name = "to", .type = ParameterType::text, .text = "NODE or NODE.PORT that receives"},
          {.name = "width",
           .type = ParameterType::integer,
           .default_value = "",
           .minimum = 1,
           .maximum = kMaximumChannels,
           .text = "Number of channels; what the nodes and other connections say when it is left "
                   "out"},
          {.name = "delay",
           .type = ParameterType::text,
           .default_value = "",
           .text = "A time, or ticks: 5 ms, 2 ticks; a cycle needs one"}};
}

}  // namespace spikeloop
