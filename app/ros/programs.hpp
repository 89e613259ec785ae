// The ROS 1 adapters as MUSIC programs, each under the names that two older families gave it.
#pragma once

#include <string_view>

#include "spikeloop/process/music_main.hpp"
#include "spikeloop/ros1/session.hpp"

namespace spikeloop {

enum class RosWay {
  messages_to_signal,
  messages_to_spikes,
  signal_to_messages,
};

/// One name, and what the older program of this name took for keys that are not written.
struct RosProgram {
  const char* name;
  RosWay way;
  const char* node_name;
  const char* topic = "";         ///< "": must be given
  const char* command_rate = "";  ///< Hz
  const char* command_rate_key = "command_rate";
  const char* mapping_file = "";  ///< "": none
};

/// Null for another name.
const RosProgram* find_ros_program(std::string_view name);

music::ProgramText sensor_text(const RosProgram& program);
int run_sensor(music::Process& process, const RosProgram& program);

music::ProgramText event_text(const RosProgram& program);
int run_events(music::Process& process, const RosProgram& program);

music::ProgramText command_text(const RosProgram& program);
int run_command(music::Process& process, const RosProgram& program);

/// Keys that all have.
std::vector<ParameterDescription> connection_parameters(const RosProgram& program);
/// A name that the file gives is taken as it is; the default gets a suffix of its own, so that a
/// second adapter does not end the first one.
ros1::SessionSettings session_settings(const Parameters& parameters);
/// Puts a topic's port `out` into `out`, and runs: that much all sensors do. `more` has what this
/// one does besides; the end warns when not one message has come.
int run_topic(music::Process& process, const std::string& topic, Source& sensor, Sink& out,
              GraphDescription more = {}, music::Process::LoopHooks hooks = {});
/// @throws ConfigurationError when the file gives no topic.
std::string required_topic(const music::Process& process, const Parameters& parameters,
                           const std::string& example);

}  // namespace spikeloop
