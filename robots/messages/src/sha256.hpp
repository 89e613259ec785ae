// SHA-256 (FIPS 180-4): how ROS 2 names a version of a message type. No protection against
// anything.
#pragma once

#include <string>
#include <string_view>

namespace spikeloop::messages {

/// 64 lower-case hexadecimal digits.
std::string sha256_hex(std::string_view text);

}  // namespace spikeloop::messages
