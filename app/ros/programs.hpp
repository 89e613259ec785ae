// The ROS adapters as MUSIC programs, each under the names that two older families gave it.
#pragma once

#include "spikeloop/config/older_programs.hpp"
#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/process/music_main.hpp"
#include "spikeloop/session/open.hpp"

namespace spikeloop {

music::ProgramText sensor_text(const RosProgram& program);
int run_sensor(music::Process& process, const RosProgram& program);

music::ProgramText event_text(const RosProgram& program);
int run_events(music::Process& process, const RosProgram& program);

music::ProgramText command_text(const RosProgram& program);
int run_command(music::Process& process, const RosProgram& program);

/// Keys of a topic's program: those of the node that an experiment has for it, `own` ones, and
/// those of its connection with ROS.
std::vector<ParameterDescription> program_parameters(const RosProgram& program,
                                                     std::vector<ParameterDescription> own);
/// The key of older sensors that does nothing.
ParameterDescription update_rate_parameter();

/// What a section says.
struct Section {
  Parameters keys;        ///< all of them
  experiment::Node node;  ///< as an experiment has it
  session::Settings ros{};
};
/// @param declared as program_parameters()
/// @throws ConfigurationError as resolve(), and for names that this ROS does not have.
Section read_section(const music::Process& process, const RosProgram& program,
                     const std::vector<ParameterDescription>& declared);

/// Puts a topic's port `out` into `out`, and runs: that much all sensors do. `more` has what this
/// one does besides; the end warns when not one message has come.
int run_topic(music::Process& process, const Section& section, Source& sensor, Sink& out,
              GraphDescription more = {}, music::Process::LoopHooks hooks = {});

}  // namespace spikeloop
