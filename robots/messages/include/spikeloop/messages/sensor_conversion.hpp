// From a sensor message to the channels of a port.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/sensor_rule.hpp"

namespace spikeloop::messages {

class Reading;

/// How each type becomes channels:
///
/// | type                     | channels                                                       |
/// |--------------------------|----------------------------------------------------------------|
/// | sensor_msgs/LaserScan    | a beam each, range_min to range_max as -1 to 1, from right to left
/// | | geometry_msgs/Twist      | linear.x, angular.z, limited to [-1, 1]                        |
/// | std_msgs/Float64MultiArray | the data as they are                                         |
/// | nav_msgs/Odometry        | position x, y, z in metres, as many as the port has             |
/// | sensor_msgs/Image, CompressedImage | see images::ImageConversion; without a rule its grey  |
///
/// A beam nearer than range_min, -inf too, is -1 (too close); one beyond range_max, +inf too, is 1
/// (nothing there), as REP 117 says. NaN is not a reading, and so is 0, which many drivers send
/// instead: the beam keeps its last value (NaN before the first).
/// So does a pixel without a reading. `scan` of the rule resamples a LaserScan by angle: a channel
/// is the nearest of the beams that are closer to its direction than to another one's; if there are
/// none, the next beam, at most one angle_increment away.
///
/// A channel keeps `initial` until a message has a valid value for it.
///
/// A message may have another number of values than the port has channels: surplus values are left
/// out, channels without a value keep their last one. With `fields`, any type: the numbers of these
/// paths one after the other. Elements that a path names and the message does not have are no
/// reading: their channels keep their values.
class SensorConversion {
 public:
  struct Counts {
    std::uint64_t messages = 0;
    std::uint64_t cropped = 0;           ///< messages with more values than the port has channels
    std::uint64_t short_messages = 0;    ///< with fewer: the channels without one keep their value
    std::uint64_t invalid_readings = 0;  ///< beams, pixels, values that `hold` their channel
    std::uint64_t without_reading = 0;   ///< messages without a single number, or to `skip`
    std::uint64_t malformed = 0;         ///< messages that could not be read at all
  };

  /// @param strict a message with another number of values than the port has channels is an error
  /// @param initial value of every channel before its first valid value; nullopt: NaN
  /// @throws ConfigurationError: a type without a rule, unknown paths, a rule for pictures with
  /// another type; when `strict`, a type whose number of values is known and is not the port's
  /// width.
  SensorConversion(const Catalog& catalog, std::string_view type, const SensorRule& rule,
                   std::uint32_t width, bool strict, std::optional<double> initial = {});
  ~SensorConversion();
  SensorConversion(SensorConversion&&) noexcept;

  /// Number of values of every message for a port of this width; nullopt if each message has its
  /// own number.
  std::optional<std::size_t> width() const;
  /// What to write if the number of values changes from message to message. Empty if only the width
  /// of the connection can be changed.
  std::string length_remedy() const;

  /// Number of values that this message has for a sensor. 0: it has no value, and the number
  /// differs from message to message.
  /// @throws ConfigurationError as the constructor; TransportError when it cannot be read.
  static std::uint32_t count(const Catalog& catalog, std::string_view type, const SensorRule& rule,
                             std::span<const std::byte> message);

  /// Updates `channels()`. False: the message was malformed or left out, or has no number for any
  /// channel; then channels only change if it `passes_nan()`.
  /// @throws ConfigurationError naming both widths when `strict` and they differ; when a rule for
  /// images does not fit the image, or its encoding or format cannot be read.
  bool convert(std::span<const std::byte> message);

  /// True if the newest message has set channels to NaN, because their fields pass it on.
  bool passes_nan() const { return passes_nan_; }

  std::span<const double> channels() const { return channels_; }
  const Counts& counts() const { return counts_; }
  /// Returns and removes the oldest warning, each kind of which comes once. Empty if there is none.
  std::string take_warning();
  /// Warning about channels for which no message had a value, for the end of a run with few
  /// messages. Empty if there are no such channels, or if it has been among the warnings.
  std::string unread() const;
  const std::string& type() const { return type_; }

 private:
  /// Contents of the messages for a channel, in ascending order.
  enum class Seen : std::uint8_t { nothing, no_reading, value };

  /// Counts and reports a message of another length. True if it has surplus values.
  bool fit();
  void warn_of_length(const std::string& difference, std::size_t whole, bool surplus);
  /// Updates channels unless the message is left out. True if a channel has got a number.
  bool take_values();
  void warn_of_no_reading(std::span<const std::byte> message);
  std::string describe_unread() const;
  void warn(std::string text);

  std::string type_;
  bool strict_ = false;
  bool whole_ = false;  ///< the newest message was not left out
  bool passes_nan_ = false;
  bool any_whole_ = false;  ///< a message was not left out
  bool any_reading_ = false;
  bool warned_of_no_reading_ = false;
  bool warned_of_unread_ = false;  ///< before any reading
  std::unique_ptr<Reading> reading_;
  std::optional<double> initial_;
  std::vector<double> channels_;
  std::vector<Seen> seen_;       ///< per channel
  std::size_t most_values_ = 0;  ///< most values in a message so far
  Counts counts_;
  std::vector<std::string> warnings_;
};

}  // namespace spikeloop::messages
