// What programs of one job share outside of MUSIC: ROS topics and ZeroMQ addresses.
#pragma once

#include <string>

#include "spikeloop/launch/check.hpp"
#include "spikeloop/launch/programs.hpp"

namespace spikeloop::launch {

/// The topic or address of a section, as it is written, or the program's own.
std::string written_place(const MusicFile& file, const MusicSection& section,
                          const Program& program);
/// scan and /scan// are one topic, as long as no namespace is set. Empty: none.
std::string topic_name(const std::string& written);

/// Two programs that write to one topic or address, and a job that hears itself.
Diagnostics check_external_topics(const MusicFile& file, bool strict);

}  // namespace spikeloop::launch
