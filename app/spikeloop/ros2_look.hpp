// What the launcher asks of ROS 2.
#pragma once

#include <string>

namespace spikeloop::app {

/// Whether somebody publishes this topic of scans. Takes 1.5 s when nobody does: who runs another
/// DDS may need a second to be heard of.
/// @throws ConfigurationError for what the environment says of ROS 2 and cannot be.
bool published_in_ros2(const std::string& topic);

}  // namespace spikeloop::app
