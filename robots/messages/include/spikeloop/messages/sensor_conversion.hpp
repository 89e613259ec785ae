// From a sensor message to the channels of a port.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/messages/field_path.hpp"

namespace spikeloop::messages {

/// How each type becomes channels:
///
/// | type                     | channels                                                       |
/// |--------------------------|----------------------------------------------------------------|
/// | sensor_msgs/LaserScan    | a beam each, 2 (r - range_min) / (range_max - range_min) - 1     |
/// | geometry_msgs/Twist      | linear.x, angular.z, limited to [-1, 1]                        |
/// | std_msgs/Float64MultiArray | the data as they are                                         |
/// | nav_msgs/Odometry        | position x, y, z in metres, as many as the port has             |
///
/// A beam nearer than range_min, -inf too, is -1 (too close); one beyond range_max, +inf too, is 1
/// (nothing there), as REP 117 says. NaN is no reading, and so is 0, which many drivers send
/// instead: the beam keeps its last value (NaN before the first).
/// With `fields`, any type: the numbers of these paths one after the other, as they are. Elements
/// that a path names and the message does not have are no reading: their channels keep their values.
class SensorConversion {
 public:
  struct Counts {
    std::uint64_t messages = 0;
    std::uint64_t cropped = 0;           ///< messages with more values than the port has channels
    std::uint64_t short_messages = 0;    ///< with fewer: the channels without one keep their value
    std::uint64_t invalid_readings = 0;  ///< beams
    std::uint64_t without_reading = 0;   ///< messages without a single reading
    std::uint64_t malformed = 0;         ///< messages that could not be read at all
  };

  /// @param strict a message that does not fit the port is an error
  /// @throws ConfigurationError: a type without a rule, unknown paths; when `strict`, a type whose
  /// number of values is known and is not the port's width.
  SensorConversion(const Catalog& catalog, std::string_view type,
                   const std::vector<std::string>& fields, std::uint32_t width, bool strict);

  /// Updates `channels()`. False: the message was malformed, or had no reading for any channel, and
  /// changed nothing.
  /// @throws ConfigurationError naming both widths when `strict` and they differ.
  bool convert(std::span<const std::byte> message);

  std::span<const double> channels() const { return channels_; }
  const Counts& counts() const { return counts_; }
  /// What the last convert() found worth telling, once a kind; else empty.
  std::string take_warning();
  const std::string& type() const { return type_; }

 private:
  enum class Rule : std::uint8_t { scan, limited, raw };

  void read_values(std::span<const std::byte> message);
  void scale_scan(double range_min, double range_max);
  void fit(std::size_t count);

  std::string type_;
  Rule rule_ = Rule::raw;
  bool strict_ = false;
  std::vector<FieldReader> readers_;
  std::vector<double> values_;
  std::vector<std::size_t> missing_;  ///< of the values, those that the message does not have
  std::vector<double> channels_;
  Counts counts_;
  std::string warning_;
};

}  // namespace spikeloop::messages
