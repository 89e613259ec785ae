#include "sensor_topics.hpp"

#include <fmt/format.h>

#include <atomic>
#include <sstream>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop {
namespace {

[[noreturn]] void refuse_sensor(const Parameters& keys, const std::string& text) {
  throw ConfigurationError(
      keys.where("sensor_topics"),
      with_code(Code::wrong_shape,
                "sensor_topics: '{}' is not a topic with its type and timeout in s; write "
                "sensor_topics=/scan:sensor_msgs/LaserScan:0.5, and others behind a comma",
                text));
}

SensorTopic sensor_topic(const Parameters& keys, const std::string& text) {
  const auto first = text.find(':');
  const auto last = text.rfind(':');
  if (first == std::string::npos || last == first) {
    refuse_sensor(keys, text);
  }
  double timeout = 0;
  try {
    timeout = parse_quantity(text.substr(last + 1), "s");
  } catch (const ConfigurationError&) {
    refuse_sensor(keys, text);
  }
  if (!(timeout > 0 && timeout < 1e9)) {
    refuse_sensor(keys, text);
  }
  return {{text.substr(0, first), from_seconds(timeout)}, text.substr(first + 1, last - first - 1)};
}

class Arrivals : public Source {
 public:
  Arrivals(topics::Session& session, const SensorTopic& topic)
      : subscriber_(session.subscriber({.topic = topic.sensor.topic,
                                        .message_type = topic.message_type,
                                        .queue = 1,
                                        .take = [this](auto) { newest_ = wall_now(); }})) {}

  std::vector<EndpointPort> ports() const override { return {{"out", PortKind::signal, 1}}; }
  void receive(const Step& step) override {
    const TimeNs newest = newest_;
    if (newest != received_) {
      received_ = newest;
      const SignalOutput out = step.signal_output();
      out.values()[0] = to_seconds(newest);
      out.commit();
    }
  }

 private:
  std::atomic<TimeNs> newest_{0};  ///< 0: no message yet
  TimeNs received_ = 0;
  std::unique_ptr<topics::RawSubscriber> subscriber_;
};

}  // namespace

ParameterDescription sensor_topics_parameter() {
  return {.name = "sensor_topics",
          .type = ParameterType::text,
          .default_value = "",
          .text = "Topics with timeouts that stop the robot: TOPIC:TYPE:SECONDS,..."};
}

std::vector<SensorTopic> sensor_topics(const Parameters& keys, messages::Dialect ros) {
  std::vector<SensorTopic> topics;
  std::istringstream list(keys.text("sensor_topics"));
  for (std::string text; std::getline(list, text, ',');) {
    SensorTopic topic = sensor_topic(keys, text);
    topics.push_back(located_at(keys.where("sensor_topics"), [&] {
      topics::check_topic(ros, topic.sensor.topic);
      topic.message_type =
          messages::Catalog::for_type(ros, topic.message_type).full_name(topic.message_type);
      return topic;
    }));
  }
  return topics;
}

std::unique_ptr<Source> arrivals(topics::Session& session, const SensorTopic& topic) {
  return std::make_unique<Arrivals>(session, topic);
}

}  // namespace spikeloop
