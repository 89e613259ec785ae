#include "spikeloop/experiment/endpoints.hpp"

#include <fmt/format.h>

#include <limits>

#include "spikeloop/core/number_or_word.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"
#include "spikeloop/record/playback.hpp"
#include "spikeloop/sensing/event_keys.hpp"
#include "spikeloop/sensing/sensor_keys.hpp"

namespace spikeloop::experiment {
topics::SensorSettings sensor_settings(const Parameters& parameters) {
  return {.topic = parameters.text("topic"),
          .message_type = parameters.text("message"),
          .rule = sensing::sensor_rule(parameters),
          .initial = number_or_word(parameters, "initial", "none", "write for example 0")};
}

bool takes_picture(const Parameters& parameters) {
  const std::string& type = parameters.text("message");
  return !parameters.given("fields") &&
         (type == "sensor_msgs/Image" || type == "sensor_msgs/CompressedImage");
}

messages::EventSettings event_settings(const Parameters& parameters) {
  const std::string& type = parameters.text("message");
  located_at(parameters.where("message"), [&] { messages::check_event_type(type); });
  return sensing::event_settings(parameters, type);
}

topics::EventSensorSettings event_sensor_settings(const Parameters& parameters) {
  return {.topic = parameters.text("topic"),
          .events = event_settings(parameters),
          .latency = from_seconds(parameters.number("latency"))};
}

std::uint32_t count_channels(const Node& sensor, messages::Dialect ros,
                             std::span<const std::byte> message) {
  const Parameters& keys = sensor.parameters;
  if (sensor.kind == kRosEventSensor) {
    const std::uint64_t channels = messages::event_channels(event_settings(keys), ros, message);
    return channels <= std::numeric_limits<std::uint32_t>::max()
               ? static_cast<std::uint32_t>(channels)
               : 0;
  }
  const std::string& type = keys.text("message");
  const messages::Catalog& catalog = messages::Catalog::for_type(ros, type);
  const messages::SensorRule rule = sensing::sensor_rule(keys);
  located_at(sensing::place_of_rule(keys),
             [&] { return messages::SensorConversion(catalog, type, rule, 0, false); });
  try {
    return messages::SensorConversion::count(catalog, type, rule, message);
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(sensor.where, fmt::format("node '{}': topic '{}': {}", sensor.name,
                                                       keys.text("topic"), error.what()));
  }
}

std::unique_ptr<Source> playback(const Node& node) {
  const std::string& file = node.parameters.text("file");
  const std::string& stream = node.parameters.text("stream");
  return located_at(node.where, [&] {
    return node.kind == kSpikePlayback ? record::make_spike_playback(file, stream)
                                       : record::make_signal_playback(file, stream);
  });
}

}  // namespace spikeloop::experiment
