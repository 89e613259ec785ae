// The ROS adapters as MUSIC programs, each under the names that two older families gave it.
#pragma once

#include <string_view>

#include "spikeloop/config/older_programs.hpp"
#include "spikeloop/messages/dialect.hpp"
#include "spikeloop/process/music_main.hpp"
#include "spikeloop/session/open.hpp"

namespace spikeloop {

music::ProgramText sensor_text(const RosProgram& program);
int run_sensor(music::Process& process, const RosProgram& program);

music::ProgramText event_text(const RosProgram& program);
int run_events(music::Process& process, const RosProgram& program);

music::ProgramText command_text(const RosProgram& program);
int run_command(music::Process& process, const RosProgram& program);

/// Keys that all have.
std::vector<ParameterDescription> connection_parameters(const RosProgram& program);
/// The version of ROS.
messages::Dialect ros_of(const Parameters& parameters);
/// A name that the file gives is taken as it is; the default gets a suffix of its own, so that a
/// second adapter does not end the first one.
session::Settings session_settings(const Parameters& parameters);
struct TopicIn {
  std::string name;
  messages::Dialect ros;
};

/// Puts a topic's port `out` into `out`, and runs: that much all sensors do. `more` has what this
/// one does besides; the end warns when not one message has come.
int run_topic(music::Process& process, const TopicIn& topic, Source& sensor, Sink& out,
              GraphDescription more = {}, music::Process::LoopHooks hooks = {});
/// @throws ConfigurationError when the file gives no topic.
std::string required_topic(const music::Process& process, const Parameters& parameters,
                           const std::string& example);

}  // namespace spikeloop
