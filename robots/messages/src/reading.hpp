// The ways to take numbers out of a sensor's messages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/sensor_rule.hpp"

namespace spikeloop::messages {

/// Whether a channel keeps its value, and why.
enum class Held : std::uint8_t {
  no,
  no_reading,  ///< the message has none here
  missing      ///< the message does not have this element
};

/// What one message brings, channel by channel.
struct ReadValues {
  std::vector<double> numbers;
  std::vector<Held> held;
};

/// Takes the numbers of one message after the other.
class Reading {
 public:
  Reading() = default;
  virtual ~Reading() = default;
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;

  /// Number of values of a message; nothing when that is the message's to say.
  virtual std::optional<std::size_t> width() const = 0;
  /// What names the value of a channel in the file; that the message does not have all of them is
  /// known where paths say how many they are.
  virtual std::string path_of(std::size_t /*channel*/) const { return "value"; }
  /// Replaces values(). False: the message is to be left out.
  /// @throws TransportError when it cannot be read.
  bool take(std::span<const std::byte> message) {
    values_.numbers.clear();
    values_.held.clear();
    return read(message, values_);
  }
  const ReadValues& values() const { return values_; }

 private:
  virtual bool read(std::span<const std::byte> message, ReadValues& values) = 0;

  ReadValues values_;
};

/// @param width of the port: an Odometry gives as many values as it has
/// @throws ConfigurationError as SensorConversion.
std::unique_ptr<Reading> make_reading(const Catalog& catalog, const std::string& type,
                                      const SensorRule& rule, std::uint32_t width);

}  // namespace spikeloop::messages
