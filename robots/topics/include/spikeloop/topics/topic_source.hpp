// A topic as a source of a graph: what all sensors have in common.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "spikeloop/core/endpoint.hpp"

namespace spikeloop::topics {

/// Keeps a message that an endpoint took or sent. Called in the loop: of a sensor for every message
/// that a tick uses, in order, with the time at which the tick begins; of a command with the time
/// at which it ends. May be empty.
using Keep = std::function<void(TimeNs time, std::span<const std::byte> message)>;

class TopicSource : public Source {
 public:
  virtual bool has_publishers() const = 0;
  /// Messages that have come and are known to the next receive().
  virtual std::uint64_t received() const = 0;
  /// Throws what receive() would.
  virtual void require_sound() const = 0;
};

}  // namespace spikeloop::topics
