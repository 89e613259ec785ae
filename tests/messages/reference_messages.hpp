// Messages as other people's serializers make them. Compiled as C++17, for Debian's headers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace reference {

/// A number of elements, a number or a text of a message.
struct Atom {
  double number = 0;
  std::string text;
};

/// The types of ROS 1 that Debian has headers of.
std::vector<std::string> types();
std::string md5(const std::string& type);
/// The text with comments, and those of all parts.
std::string definition(const std::string& type);
/// What roscpp's generated serializer makes of these contents.
std::vector<std::uint8_t> serialize(const std::string& type, const std::vector<Atom>& atoms);

}  // namespace reference
