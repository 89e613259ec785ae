#include "spikeloop/experiment/endpoints.hpp"

#include <fmt/format.h>

#include "spikeloop/command/mapping.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"
#include "spikeloop/record/playback.hpp"
#include "spikeloop/sensing/sensor_keys.hpp"

namespace spikeloop::experiment {

messages::SensorRule sensor_rule(const Parameters& parameters) {
  const auto written = [&](const char* key) {
    return WrittenValue{parameters.text(key), parameters.where(key)};
  };
  return sensing::sensor_rule(written("fields"), written("image"));
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

std::uint32_t count_values(const Parameters& parameters, std::span<const std::byte> message) {
  try {
    const std::string& type = parameters.text("message");
    return messages::SensorConversion::count(
        messages::Catalog::for_type(messages::Dialect::ros1, type), type, sensor_rule(parameters),
        message);
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
