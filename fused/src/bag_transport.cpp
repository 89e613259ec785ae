#include "bag_transport.hpp"

namespace spikeloop::fused {

std::unique_ptr<Source> BagTransport::sensor(const SensorSpec& spec) {
  const std::string& topic = spec.part.parameters.text("topic");
  auto feed =
      std::make_unique<Feed>(Feed{topic, reader_.stream(topic, spec.part.name), std::nullopt});
  feed->next = feed->stream.next();
  feeds_.push_back(std::move(feed));
  return make_memory_sensor(feeds_.back()->node, spec);
}

void BagTransport::begin(TimeNs time) {
  for (const auto& feed : feeds_) {
    while (feed->next && feed->next->time <= time) {
      feed->node.publish(feed->topic, feed->next->bytes, time);
      feed->next = feed->stream.next();
    }
  }
}

}  // namespace spikeloop::fused
