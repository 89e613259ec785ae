// Topic as a source of a graph: the common part of all sensors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "spikeloop/core/endpoint.hpp"

namespace spikeloop::topics {

/// Records a message that an endpoint has received or sent. Called in the loop: for every message
/// of a sensor that a tick uses, in order, with the time at which the tick begins; for every
/// message of a command with the time at which the tick ends. May be empty.
using Keep = std::function<void(TimeNs time, std::span<const std::byte> message)>;

class TopicReader;

class TopicSource : public Source {
 public:
  bool has_publishers() const;
  /// Number of messages that have arrived and that the next receive() takes into account.
  std::uint64_t received() const;
  /// Throws the errors of receive().
  void require_sound() const;

 private:
  virtual const TopicReader& reader() const = 0;
};

}  // namespace spikeloop::topics
