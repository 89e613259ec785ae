// A bag in the robot's place.
#pragma once

#include <string>
#include <vector>

#include "memory_topics.hpp"
#include "spikeloop/bag/reader.hpp"
#include "spikeloop/fused/transport.hpp"

namespace spikeloop::fused {

/// Sensors take their topics' messages from the bag, each at the first tick that is not before its
/// time. Nobody is at the other end of commands.
class BagTransport : public Transport {
 public:
  /// @throws FileError as bag::Reader.
  explicit BagTransport(const std::string& bag) : reader_(bag) {}

  std::unique_ptr<Source> sensor(const SensorSpec& spec) override;
  std::unique_ptr<CommandEnd> command(const CommandSpec& spec) override {
    return make_memory_command(nobody_, spec);
  }
  /// @throws FileError when the bag is damaged.
  void begin(TimeNs time) override;

 private:
  /// Of a node, as two of one topic need not have taken the same messages.
  struct Feed {
    std::string topic;
    bag::Stream stream;
    std::optional<bag::Message> next;
    MemoryTopics node{};
  };

  bag::Reader reader_;
  std::vector<std::unique_ptr<Feed>> feeds_;
  MemoryTopics nobody_;
};

}  // namespace spikeloop::fused
