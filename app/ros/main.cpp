// spikeloop-ros: a ROS 1 topic as a MUSIC program, under the name of one of its two adapters.
#include <fmt/format.h>

#include "programs.hpp"
#include "spikeloop/command/watch.hpp"

namespace {

using namespace spikeloop;

music::ProgramText general_text() {
  music::ProgramText text;
  text.name = "spikeloop-ros";
  text.summary = "Connects ROS 1 topics with MUSIC, under one of two names";
  text.notes =
      "Write binary=ros_sensor_adapter (messages to channels) or binary=ros_command_adapter\n"
      "(channels to messages); each answers --help.\n";
  return text;
}

int run(music::Process& process) {
  if (process.program() == "ros_sensor_adapter") {
    return run_sensor(process);
  }
  if (process.program() == "ros_command_adapter") {
    return run_command(process);
  }
  throw ConfigurationError(fmt::format(
      "binary={} does not say which way messages go; write binary=ros_sensor_adapter or "
      "binary=ros_command_adapter",
      process.program()));
}

}  // namespace

int main(int argc, char** argv) {
  // Before MPI and roscpp start threads.
  command::Watch::block_signals();
  const std::string name = music::called_as(argc, argv);
  const music::ProgramText text = name == "ros_sensor_adapter"    ? sensor_text()
                                  : name == "ros_command_adapter" ? command_text()
                                                                  : general_text();
  return music::music_main(argc, argv, text, run);
}
