// A mapping of channels to the fields of a message, as what a command needs of it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/command/limiter.hpp"
#include "spikeloop/config/mapping_file.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop::command {

/// The fields of a mapping; of a mapping of all channels, one per channel of a port of this width.
std::vector<CommandField> components(const CommandMapping& mapping, std::uint32_t width);

/// Changes that are not sent: `fraction` of the range of each component. The range is that between
/// its limits; without them, that of a channel in [-1, 1].
std::vector<double> deadbands(const std::vector<CommandField>& components, double fraction);

/// Limits of velocities (Twist, also within another message) that have none: 1 m/s and 3 rad/s in
/// either direction, as fast as small indoor robots drive. None for other fields.
/// @param message_type "geometry_msgs/Twist"
/// @param field its path, "linear.x"
Bounds default_bounds(std::string_view message_type, std::string_view field);
/// Limits of the components. @param with_default default_bounds() for fields without any limit
std::vector<Bounds> bounds(const CommandMapping& mapping, std::uint32_t width, bool with_default);

/// Value of each component at a stop. Fields without a rule of their own: the number of a position
/// is held (of `position[name=NAME]` the measured one of joint NAME), all others are 0.
std::vector<StopRule> stop_rules(const CommandMapping& mapping, std::uint32_t width);

/// Paths of the fields of a message; "data" alone for all channels.
std::vector<std::string> field_paths(const CommandMapping& mapping);

/// The mapping as a node, so that its output can be recorded. Ports: `in`, the channels; `out`, one
/// value per component.
NodeClass command_map_class(std::vector<CommandField> components);

}  // namespace spikeloop::command
