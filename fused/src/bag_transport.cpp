#include "bag_transport.hpp"

#include "spikeloop/core/log.hpp"
#include "spikeloop/experiment/recording.hpp"

namespace spikeloop::fused {

BagTransport::BagTransport(const experiment::Experiment& experiment)
    : reader_(experiment.robot->recording != nullptr
                  ? experiment.robot->recording
                  : std::make_shared<const bag::Reader>(experiment.robot->bag)),
      commands_(reader_->dialect()) {
  for (const std::string& warning : experiment::recording_warnings(experiment, *reader_)) {
    log::warning("{}", warning);
  }
}

BagTransport::Feed::Feed(const bag::Reader& reader, const experiment::Node& sensor)
    : stream(reader.stream(sensor.parameters.text("topic"), sensor.name)),
      next(stream.next()),
      session(reader.dialect()),
      publisher(
          session.publisher(sensor.parameters.text("topic"), sensor.parameters.text("message"))) {}

topics::Session& BagTransport::session(const experiment::Node& node) {
  if (node.role != experiment::Role::source) {
    return commands_;
  }
  return feeds_.emplace_back(std::make_unique<Feed>(*reader_, node))->session;
}

void BagTransport::begin(TimeNs time) {
  for (const auto& feed : feeds_) {
    while (feed->next && feed->next->time <= time) {
      feed->publisher->publish(feed->next->bytes);
      feed->next = feed->stream.next();
    }
  }
}

}  // namespace spikeloop::fused
