// The text of a ROS message definition as data.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/messages/dialect.hpp"

namespace spikeloop::messages {

/// The types that need no definition. `char` is uint8; `byte` is int8 in ROS 1 and uint8 in ROS 2.
/// A time is seconds and nanoseconds: ROS 1's `time` and `duration`, and ROS 2's messages
/// builtin_interfaces/Time and Duration.
enum class Primitive : std::uint8_t {
  boolean,
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64,
  text,
  time,
  duration,
  message  ///< another definition
};

enum class ArrayKind : std::uint8_t { none, fixed, variable };

/// What a field has when nobody sets it: one value, or those of an array's elements. Empty: zero,
/// no text, no elements.
struct DefaultValue {
  std::vector<double> numbers{};
  std::vector<std::string> texts{};
};

/// "float64[36] covariance".
struct FieldDefinition {
  std::string written_type;  ///< as written, with brackets: part of the md5 sum
  std::string type;          ///< without brackets and bounds; messages with their package
  std::string name;
  Primitive primitive = Primitive::message;
  ArrayKind array = ArrayKind::none;
  std::uint32_t count = 0;         ///< of a fixed array; the most of a variable one, 0: any number
  std::uint32_t longest_text = 0;  ///< bytes; 0: any number
  DefaultValue otherwise{};        ///< ROS 2 only
};

/// "uint8 OK=0".
struct ConstantDefinition {
  std::string type;
  std::string name;
  std::string value;  ///< as written; ROS 2's texts without their quotation marks
};

struct Definition {
  std::string name;  ///< "sensor_msgs/LaserScan"
  std::string text;
  std::vector<FieldDefinition> fields;
  std::vector<ConstantDefinition> constants;
};

/// Parses one `.msg` text. `name` is "package/Type": types without a package belong to its package,
/// and ROS 1's `Header` is std_msgs/Header.
/// @param file where the text stands, for messages; empty: Type.msg
/// @throws ConfigurationError with file and line: what the line lacks and what to write.
Definition parse_definition(std::string_view name, std::string_view text, Dialect dialect,
                            std::string_view file = {});

}  // namespace spikeloop::messages
