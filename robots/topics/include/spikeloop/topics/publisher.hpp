// Command messages from components' values.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::topics {

class Publisher {
 public:
  /// @param fields a path a value; a single path to a variable array, like `data`, takes all values
  /// @param stamped publish() writes the wall time into `header.stamp` of a type that has it,
  /// unless one of the fields is in the header
  /// @throws ConfigurationError: unknown type or fields, an impossible topic.
  Publisher(Session& session, const std::string& topic, const std::string& message_type,
            const std::vector<std::string>& fields, bool stamped = false);
  ~Publisher();
  /// Throws what the constructor would, without ROS.
  static void check(messages::Dialect ros, const std::string& topic,
                    const std::string& message_type, const std::vector<std::string>& fields);
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// The bytes of a message with these values, all other fields zero, also the stamp. Safe to call
  /// from any thread.
  std::vector<std::byte> message(std::span<const double> values) const;
  /// Sends that; as RawPublisher::publish. Returns its bytes, until the next one is sent.
  std::span<const std::byte> publish(std::span<const double> values);
  const RawPublisher& raw() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::topics
