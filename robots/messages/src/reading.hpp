// The ways to take numbers out of a sensor's messages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
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

/// A message with another number of values than there are channels for them.
struct Misfit {
  std::string path;  ///< the field; empty for all values of the message
  std::size_t values = 0;
  std::size_t channels = 0;
  std::size_t whole = 0;  ///< values of all fields of the message
};

/// What one message brings, channel by channel.
struct ReadValues {
  std::vector<double> numbers;
  std::vector<Held> held;
  std::optional<Misfit> misfit;  ///< of one of several fields
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
  /// Name of a channel's value in the experiment file or the newest message.
  virtual std::string name_of(std::size_t /*channel*/) const { return "value"; }
  /// What to write if the number of values changes from message to message; empty if there is only
  /// the width of the connection.
  virtual std::string length_remedy(std::size_t /*channels*/) const { return {}; }
  /// Remedy if no message has a value for a channel.
  /// @param missing false: the messages have NaN, or no reading, for the channel
  virtual std::string no_value_remedy(bool /*missing*/, std::size_t /*channel*/) const {
    return "give channels without a value one, as in initial: 0";
  }
  /// Names of the elements of a message from which the sensor selects by name, "[left, right]".
  /// Empty if it does not select by name.
  /// @throws TransportError if the message cannot be read
  virtual std::string names_in(std::span<const std::byte> /*message*/) const { return {}; }
  /// Replaces values(). Returns false if the message is to be left out; values() are replaced
  /// nevertheless.
  /// @throws TransportError when it cannot be read.
  bool take(std::span<const std::byte> message) {
    values_.numbers.clear();
    values_.held.clear();
    values_.misfit.reset();
    return read(message, values_);
  }
  const ReadValues& values() const { return values_; }
  /// Warnings since the last call.
  std::vector<std::string> take_warnings() { return std::exchange(warnings_, {}); }

 protected:
  /// An empty text is no warning.
  void warn(std::string text) {
    if (!text.empty()) {
      warnings_.push_back(std::move(text));
    }
  }

 private:
  virtual bool read(std::span<const std::byte> message, ReadValues& values) = 0;

  ReadValues values_;
  std::vector<std::string> warnings_;
};

/// @param width channels of the port, which determine the number of values of an Odometry. 0:
/// unknown
/// @throws ConfigurationError as SensorConversion.
std::unique_ptr<Reading> make_reading(const Catalog& catalog, const std::string& type,
                                      const SensorRule& rule, std::uint32_t width);

}  // namespace spikeloop::messages
