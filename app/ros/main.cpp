// spikeloop-ros: a ROS topic as a MUSIC program, under the name of one of its adapters.
#include <fmt/format.h>

#include <map>

#include "programs.hpp"
#include "spikeloop/command/watch.hpp"
#include "spikeloop/core/code.hpp"

namespace spikeloop {
namespace {

music::ProgramText general_text() {
  music::ProgramText text;
  text.name = "spikeloop-ros";
  text.summary = "Connects ROS topics with MUSIC; run by the name of an adapter";
  text.notes =
      "Write binary=ros_sensor_adapter (messages to channels), binary=ros_event_sensor_adapter\n"
      "(events of a camera to spikes) or binary=ros_command_adapter (channels to messages); each\n"
      "has --help. ros_cont_adapter and cont_ros_adapter are the first and the last one with the\n"
      "defaults of ros-music-adapters.\n";
  return text;
}

struct Adapter {
  music::ProgramText (*text)(const RosProgram&);
  int (*run)(music::Process&, const RosProgram&);
};

const Adapter& adapter_of(const RosProgram& program) {
  static const std::map<std::string_view, Adapter> kAdapters{
      {experiment::kRosSensor, {sensor_text, run_sensor}},
      {experiment::kRosEventSensor, {event_text, run_events}},
      {experiment::kRosCommand, {command_text, run_command}}};
  return kAdapters.at(program.node_class);
}

music::ProgramText text_of(const RosProgram* program) {
  return program == nullptr ? general_text() : adapter_of(*program).text(*program);
}

int run(music::Process& process) {
  const RosProgram* const program = find_ros_program(process.program());
  if (program == nullptr) {
    throw ConfigurationError(
        with_code(Code::music_job,
                  "binary={} does not say which way messages go; write binary=ros_sensor_adapter, "
                  "ros_event_sensor_adapter or ros_command_adapter",
                  process.program()));
  }
  return adapter_of(*program).run(process, *program);
}

}  // namespace

}  // namespace spikeloop

int main(int argc, char** argv) {
  using namespace spikeloop;
  // Before MPI and roscpp start threads.
  command::Watch::block_signals();
  const std::string name = music::called_as(argc, argv);
  return music::music_main(argc, argv, text_of(find_ros_program(name)), run);
}
