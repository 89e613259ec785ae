#include "spikeloop/experiment/endpoints.hpp"

#include <fmt/format.h>

#include <limits>

#include "spikeloop/command/mapping.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"
#include "spikeloop/record/playback.hpp"
#include "spikeloop/sensing/event_keys.hpp"
#include "spikeloop/sensing/sensor_keys.hpp"

namespace spikeloop::experiment {

messages::SensorRule sensor_rule(const Parameters& parameters) {
  return sensing::sensor_rule(parameters);
}

std::optional<double> sensor_initial(const Parameters& parameters) {
  const std::string& text = parameters.text("initial");
  if (text == "none") {
    return std::nullopt;
  }
  try {
    return parse_quantity(text, "");
  } catch (const ConfigurationError&) {
    throw ConfigurationError(
        parameters.where("initial"),
        fmt::format("key 'initial': '{}' is neither a number nor 'none'; write for example 0",
                    text));
  }
}

messages::EventSettings event_settings(const Parameters& parameters) {
  const std::string& type = parameters.text("message");
  located_at(parameters.where("message"), [&] { messages::check_event_type(type); });
  return sensing::event_settings(parameters, type);
}

std::uint32_t count_channels(const Parameters& parameters, std::span<const std::byte> message) {
  try {
    const std::uint64_t channels =
        messages::event_channels(event_settings(parameters), messages::Dialect::ros1, message);
    return channels <= std::numeric_limits<std::uint32_t>::max()
               ? static_cast<std::uint32_t>(channels)
               : 0;
  } catch (const Error&) {
    return 0;  // told elsewhere
  }
}

std::uint32_t count_values(const Parameters& parameters, messages::Dialect ros,
                           std::span<const std::byte> message) {
  try {
    const std::string& type = parameters.text("message");
    return messages::SensorConversion::count(messages::Catalog::for_type(ros, type), type,
                                             sensor_rule(parameters), message);
  } catch (const Error&) {
    return 0;  // told elsewhere
  }
}

std::unique_ptr<Source> playback(const Part& part) {
  const std::string& file = part.parameters.text("file");
  const std::string& stream = part.parameters.text("stream");
  return located_at(part.where, [&] {
    return part.kind == kSpikePlayback ? record::make_spike_playback(file, stream)
                                       : record::make_signal_playback(file, stream);
  });
}

void check_command_fields(const CommandMapping& mapping, messages::Dialect ros) {
  const auto& catalog = messages::Catalog::for_type(ros, mapping.message_type);
  for (const CommandField& field : mapping.fields) {
    located_at(field.where, [&] {
      return messages::MessageWriter(catalog, mapping.message_type, {field.field}), 0;
    });
  }
  messages::MessageWriter(catalog, mapping.message_type, command::field_paths(mapping));
}

}  // namespace spikeloop::experiment
