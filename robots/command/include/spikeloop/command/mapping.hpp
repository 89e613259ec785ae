// Derives fields, limits and deadbands of a command from its mapping.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/command/limiter.hpp"
#include "spikeloop/config/mapping_file.hpp"
#include "spikeloop/core/node.hpp"

namespace spikeloop::command {

/// Fields of a mapping. A mapping of all channels has one per channel (`width`).
std::vector<CommandField> components(const CommandMapping& mapping, std::uint32_t width);

/// Deadband of each component: `fraction` of the range between its limits; without limits, of the
/// range for a channel in [-1, 1].
std::vector<double> deadbands(const std::vector<CommandField>& components, double fraction);

/// Default limits of velocities (Twist, also as part of TwistStamped): 1 m/s and 3 rad/s in either
/// direction, as fast as small indoor robots drive. Other fields have none.
/// @param message_type "geometry_msgs/Twist"
/// @param field its path, "linear.x"
Bounds default_bounds(std::string_view message_type, std::string_view field);
/// Limits of the components.
/// @param with_default applies default_bounds() to fields without any limit
std::vector<Bounds> bounds(const CommandMapping& mapping, std::uint32_t width, bool with_default);

/// Value of each component at a stop. Without a rule in the mapping, positions are held
/// (`position[name=NAME]`: at the measured position of joint NAME), and all other fields are 0.
std::vector<StopRule> stop_rules(const CommandMapping& mapping, std::uint32_t width);

/// Paths of the fields of a message; "data" alone for a mapping of all channels.
std::vector<std::string> field_paths(const CommandMapping& mapping);

/// Class of a node that applies the mapping, so that its output can be recorded. Ports: `in`:
/// channels; `out`: one value per component.
NodeClass command_map_class(std::vector<CommandField> components);

}  // namespace spikeloop::command
