// Which ROS a message is one of.
#pragma once

#include <cstdint>

namespace spikeloop::messages {

/// The two differ in definitions (the header's `seq`, what a time is) and in bytes: ROS 1's
/// serialization, packed; for ROS 2 XCDR1, little endian, aligned, behind four bytes that say so.
enum class Dialect : std::uint8_t { ros1, ros2 };

}  // namespace spikeloop::messages
