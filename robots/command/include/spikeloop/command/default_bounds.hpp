// What a field may be when nobody has said it.
#pragma once

#include <string_view>

#include "spikeloop/command/limiter.hpp"

namespace spikeloop::command {

/// Of messages whose fields have a physical meaning: velocities (Twist, also within another
/// message) 1 m/s and 3 rad/s in either direction, as fast as small indoor robots drive. None for
/// others.
/// @param message_type "geometry_msgs/Twist"
/// @param field its path, "linear.x"
Bounds default_bounds(std::string_view message_type, std::string_view field);

}  // namespace spikeloop::command
