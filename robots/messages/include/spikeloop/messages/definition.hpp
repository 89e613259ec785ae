// The text of a ROS message definition as data.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace spikeloop::messages {

/// The types that the definition language has built in. `byte` is int8 and `char` is uint8, as in
/// ROS 1; time and duration are seconds and nanoseconds.
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

/// "float64[36] covariance".
struct FieldDefinition {
  std::string written_type;  ///< as written, with brackets: part of the md5 sum
  std::string type;          ///< without brackets; messages with their package
  std::string name;
  Primitive primitive = Primitive::message;
  ArrayKind array = ArrayKind::none;
  std::uint32_t count = 0;  ///< of a fixed array
};

/// "uint8 OK=0".
struct ConstantDefinition {
  std::string type;
  std::string name;
  std::string value;
};

struct Definition {
  std::string name;  ///< "sensor_msgs/LaserScan"
  std::string text;
  std::vector<FieldDefinition> fields;
  std::vector<ConstantDefinition> constants;
};

/// Parses one `.msg` text. `name` is "package/Type": types without a package belong to its package,
/// and `Header` is std_msgs/Header.
/// @throws ConfigurationError with name and line: what the line lacks and what to write.
Definition parse_definition(std::string_view name, std::string_view text);

}  // namespace spikeloop::messages
