// A mapping file's contents as what maps channels, and as the fields of a message.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "spikeloop/command/component_map.hpp"
#include "spikeloop/config/mapping_file.hpp"

namespace spikeloop::command {

/// @param width channels of the port, which all go when the mapping says so
ComponentMap component_map(const CommandMapping& mapping, std::uint32_t width);

/// Those of a mapping's components, with the default ones for fields that have no limit of their
/// own. @param bounds one a field; any number when the mapping is of all channels
std::vector<Bounds> default_bounds(const CommandMapping& mapping, std::vector<Bounds> bounds);

/// Value of each component at a stop. Fields without a rule of their own: the number of a position
/// is held (of `position[name=NAME]` the measured one of joint NAME), all others are 0.
/// @param width components of the command
std::vector<StopRule> stop_rules(const CommandMapping& mapping, std::size_t width);

/// A path a component; "data" alone for all channels.
std::vector<std::string> field_paths(const CommandMapping& mapping);

}  // namespace spikeloop::command
