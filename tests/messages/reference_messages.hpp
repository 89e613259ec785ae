// Messages as Debian's generated serializers make them. Compiled as C++17.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace reference {

struct Message {
  std::string md5;
  std::string definition;
  std::vector<std::uint8_t> bytes;
  std::map<std::string, std::vector<double>> numbers;  ///< by field path
  std::map<std::string, std::string> texts;
};

/// The types that random_message knows.
std::vector<std::string> types();
/// A message with random contents in all fields, serialized by roscpp.
Message random_message(const std::string& type, unsigned seed);

}  // namespace reference
