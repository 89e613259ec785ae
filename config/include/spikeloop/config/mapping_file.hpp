// Mapping files: which channel goes to which field of a command message.
//
//   {"message_type": "Twist", "mapping": {"linear.x": 0, "angular.z": 1}, "min": -1, "max": 1}
//
// A field may be an object instead of a channel:
//   "linear.x": {"channel": 0, "scale": 0.5, "offset": 0, "min": -0.5, "max": 0.5, "slew": 2}
// Its value is scale * channel + offset, then limited. The file's "min" and "max" hold for fields
// that have none of their own; without any there is no limit. "slew" is the fastest change of what
// leaves, a second. A field that ends with a slice, "data[2:5]": 7, stands for its elements with
// channels from 7 on.
//
// "stop" of a field, or of the file, is its value at a stop: a number, "hold", or "hold NAME" with
// the name of a joint.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/config/message_type.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop {

/// Value of a field in the command that stops the robot.
struct StopRule {
  /// The last measured position, else the last command.
  bool hold = false;
  std::string joint{};  ///< with `hold`: joint whose measured position is held; empty: last command
  double value = 0;     ///< without `hold`

  bool operator==(const StopRule&) const = default;
};

/// Reads "0.5", "zero", "hold" or "hold NAME". @throws ConfigurationError without location.
StopRule parse_stop(std::string_view text);
/// The text that parse_stop() reads.
std::string stop_text(const StopRule& rule);

/// field = limit(scale * channel + offset)
struct CommandField {
  std::string field;          ///< path in the message, "linear.x"
  std::uint32_t channel = 0;  ///< counts from 0
  double scale = 1;
  double offset = 0;
  std::optional<double> minimum{};  ///< none: no limit
  std::optional<double> maximum{};
  std::optional<double> slew{};    ///< fastest change a second, above 0; none: any
  std::optional<StopRule> stop{};  ///< nullopt: depends on the field
  Location where{};                ///< of its line in the file

  /// Joint that the file names for the position that a stop holds. Empty if it names none.
  std::string held_joint() const { return stop ? stop->joint : ""; }
};

struct CommandMapping {
  std::string file;           ///< for messages
  std::string message_type;   ///< "geometry_msgs/Twist"
  bool all_channels = false;  ///< a Float64MultiArray of all channels, in order; no fields
  std::vector<CommandField> fields{};
  std::optional<StopRule> stop{};  ///< of all channels
};

struct MappingOptions {
  /// Relative paths start here, or else in the current directory; those in a mapping file where it
  /// lies.
  std::filesystem::path base_directory{};
  /// False reads as the older programs did, with a warning in the log: a missing file or one that
  /// is not JSON gives a Float64MultiArray of all channels; unknown keys and fields with channel
  /// -1 are left out; a message without mapping is all zero.
  bool strict = true;
  Location named_in{};  ///< where the file is named, for warnings
};

/// Parses the text of a mapping file; `file` only names it in messages.
/// @throws ConfigurationError with file, key, value and remedy.
CommandMapping parse_mapping(std::string_view text, const std::string& file,
                             const MappingOptions& options = {});

/// @throws ConfigurationError as `parse_mapping`, and when there is no such file; FileError when it
/// cannot be read.
CommandMapping read_mapping(const std::string& name, const MappingOptions& options = {});

/// @throws ConfigurationError naming field and channel when a channel is not below the port's
/// width.
void check_channels(const CommandMapping& mapping, std::uint32_t width);

}  // namespace spikeloop
