// Publishes the values of components as command messages.
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
  /// @param fields one path per value; a single path to a variable array, like `data`, takes all
  /// values
  /// @param stamped publish() writes the wall time into `header.stamp` if the type has it and none
  /// of the fields is in the header
  /// @throws ConfigurationError: unknown type or fields, an invalid topic.
  Publisher(Session& session, const std::string& topic, const std::string& message_type,
            const std::vector<std::string>& fields, bool stamped = false);
  ~Publisher();
  /// Throws the exceptions of the constructor, without a session.
  static void check(messages::Dialect ros, const std::string& topic,
                    const std::string& message_type, const std::vector<std::string>& fields);
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// Bytes of a message with these values. All other fields, also the stamp, are 0. Thread-safe.
  std::vector<std::byte> message(std::span<const double> values) const;
  /// Sends a message with these values, as RawPublisher::publish. Returns its bytes, which are
  /// valid until the next call.
  std::span<const std::byte> publish(std::span<const double> values);
  const RawPublisher& raw() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::topics
