// A bag in the robot's place.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/bag/reader.hpp"
#include "spikeloop/fused/transport.hpp"
#include "spikeloop/topics/memory_session.hpp"

namespace spikeloop::fused {

/// Sensors take their topics' messages from the bag, each at the first tick that is not before its
/// time. Nobody is at the other end of commands.
class BagTransport : public Transport {
 public:
  /// Uses the bag of the experiment, which may be open. @throws FileError as bag::Reader.
  explicit BagTransport(const experiment::Experiment& experiment);

  topics::Session& session(const experiment::Node& node) override;
  /// @throws FileError when the bag is damaged.
  void begin(TimeNs time) override;

 private:
  /// Of a node, as two of one topic need not have taken the same messages.
  struct Feed {
    Feed(const bag::Reader& reader, const experiment::Node& sensor);

    bag::Stream stream;
    std::optional<bag::Message> next;
    topics::MemorySession session;
    std::unique_ptr<topics::RawPublisher> publisher;
  };

  std::shared_ptr<const bag::Reader> reader_;
  std::vector<std::unique_ptr<Feed>> feeds_;
  topics::MemorySession commands_;
};

}  // namespace spikeloop::fused
