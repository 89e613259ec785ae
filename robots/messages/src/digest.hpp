// How both versions of ROS name a version of a message type. No protection against anything.
#pragma once

#include <string>
#include <string_view>

namespace spikeloop::messages {

/// ROS 1: MD5 (RFC 1321), 32 lower-case hexadecimal digits.
std::string md5_hex(std::string_view text);
/// ROS 2: SHA-256 (FIPS 180-4), 64 lower-case hexadecimal digits.
std::string sha256_hex(std::string_view text);

}  // namespace spikeloop::messages
