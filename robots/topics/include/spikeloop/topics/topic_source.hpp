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

class TopicReader;

class TopicSource : public Source {
 public:
  bool has_publishers() const;
  /// Messages that have come and are known to the next receive().
  std::uint64_t received() const;
  /// Throws what receive() would.
  void require_sound() const;

 private:
  virtual const TopicReader& reader() const = 0;
};

}  // namespace spikeloop::topics
