// What a sensor takes of its messages.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "spikeloop/images/image_settings.hpp"

namespace spikeloop::messages {

/// What becomes of a value that is not a number.
enum class NotANumber : std::uint8_t {
  pass,   ///< the channel gets it as it is
  hold,   ///< the channel keeps its value
  skip,   ///< the whole message is left out
  number  ///< the channel gets `instead`, neither scaled nor limited
};

/// Numbers of a message: channel = limit(scale * number + offset).
struct SensorField {
  /// As FieldReader has it. Of a sensor_msgs/PointCloud2 also points.NAME, points.NAME[first:end]:
  /// what its points have in the field NAME, row by row.
  std::string path;
  double scale = 1;
  double offset = 0;
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  NotANumber not_a_number = NotANumber::pass;
  double instead = 0;
};

/// Values of a sensor_msgs/LaserScan.
struct ScanRule {
  /// Number of directions to which scans are resampled. 0: the beams of the message.
  std::uint32_t beams = 0;
  /// First and last direction in rad, counterclockwise. nullopt: the first and last beam of each
  /// scan.
  std::optional<std::pair<double, double>> angles{};
  /// Distances in m that are mapped to -1 and 1. nullopt: range_min and range_max of the message.
  std::optional<std::pair<double, double>> range{};
};

/// Selects the values of a sensor. At most one member is set. If none is set, SensorConversion
/// reads the default fields of the type.
struct SensorRule {
  std::vector<SensorField> fields{};
  std::optional<images::ImageSettings> image{};
  std::optional<ScanRule> scan{};
};

/// The numbers of these paths as they are.
SensorRule plain_fields(const std::vector<std::string>& paths);

}  // namespace spikeloop::messages
