// What a subscriber has heard.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "spikeloop/topics/session.hpp"

namespace spikeloop::test {

using Bytes = std::vector<std::byte>;

/// A message whose fields are these bytes: XCDR1, little endian.
inline Bytes message_of(const Bytes& fields) {
  Bytes message(4 + fields.size());
  message[1] = std::byte{1};
  std::copy(fields.begin(), fields.end(), message.begin() + 4);
  return message;
}

/// Fields of this size that differ from each other.
inline Bytes pattern(std::size_t size, std::uint32_t seed = 1) {
  Bytes bytes(size);
  for (std::byte& byte : bytes) {
    seed = seed * 1664525U + 1013904223U;
    byte = static_cast<std::byte>(seed >> 24);
  }
  return bytes;
}

/// The fields of a message, without what fills it up.
inline Bytes fields_of(const Bytes& message) {
  return {message.begin() + 4, message.end()};
}

class Heard {
 public:
  /// @param queue as a Subscription's
  topics::Subscription subscription(const std::string& topic, const std::string& type,
                                    std::uint32_t queue) {
    return {.topic = topic,
            .message_type = type,
            .queue = queue,
            .take =
                [this](std::span<const std::byte> message) {
                  const std::lock_guard lock(mutex_);
                  messages_.emplace_back(message.begin(), message.end());
                },
            .refuse =
                [this](const topics::OtherType& other) {
                  const std::lock_guard lock(mutex_);
                  refusals_.push_back(other);
                }};
  }

  std::vector<Bytes> messages() const {
    const std::lock_guard lock(mutex_);
    return messages_;
  }
  std::size_t count() const {
    const std::lock_guard lock(mutex_);
    return messages_.size();
  }
  std::vector<topics::OtherType> refusals() const {
    const std::lock_guard lock(mutex_);
    return refusals_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Bytes> messages_;
  std::vector<topics::OtherType> refusals_;
};

}  // namespace spikeloop::test
