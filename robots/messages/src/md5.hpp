// MD5 (RFC 1321): how ROS 1 names a version of a message type. No protection against anything.
#pragma once

#include <string>
#include <string_view>

namespace spikeloop::messages {

/// 32 lower-case hexadecimal digits.
std::string md5_hex(std::string_view text);

}  // namespace spikeloop::messages
