// A topic in, message by message as bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "spikeloop/ros1/session.hpp"

namespace spikeloop::ros1 {

class RawSubscriber {
 public:
  /// Called in the session's thread; must not throw.
  using Callback = std::function<void(std::span<const std::byte>)>;

  /// Subscribes, with TCP_NODELAY, to this type: roscpp refuses publishers of another one.
  /// @param queue messages that may wait for the session's thread; of more, the oldest are lost: 1
  /// for the newest, 0 for all
  /// @throws ConfigurationError for an unknown type or an impossible topic.
  RawSubscriber(Session& session, const std::string& topic, const std::string& message_type,
                Callback callback, std::uint32_t queue = 1);
  /// Waits for a callback that is running; none runs afterwards.
  ~RawSubscriber();
  RawSubscriber(const RawSubscriber&) = delete;
  RawSubscriber& operator=(const RawSubscriber&) = delete;

  bool has_publishers() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::ros1
