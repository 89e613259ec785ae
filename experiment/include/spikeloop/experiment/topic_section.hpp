// A section of a .music file that runs a topic's program, as a node of an experiment: its keys are
// parameters of the node's class, some of them under the names that older programs gave them.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "spikeloop/config/older_programs.hpp"
#include "spikeloop/core/node.hpp"
#include "spikeloop/core/parameters.hpp"

namespace spikeloop::experiment {

/// A key of a section, and what it sets.
struct SectionKey {
  std::string_view name;       ///< "emergency_stop_timeout"
  std::string_view parameter;  ///< "emergency_stop"
  std::string_view inner{};    ///< "timeout", which the map has; empty: the parameter itself
};

/// Of ros_sensor, ros_event_sensor, ros_command. Parameters without a key stand in a mapping file,
/// or are an experiment's alone.
std::span<const SectionKey> section_keys(std::string_view node_class);

/// The class itself.
const NodeClass& topic_class(std::string_view node_class);

/// The declarations of these keys: the class's own, with the program's defaults.
std::vector<ParameterDescription> section_parameters(const RosProgram& program);

/// All parameters of the class: those that `section`, which was resolved with the declarations
/// above among others, has keys for, and the class's defaults. `message` of a ros_command is empty.
Parameters class_parameters(const RosProgram& program, const Parameters& section);

}  // namespace spikeloop::experiment
