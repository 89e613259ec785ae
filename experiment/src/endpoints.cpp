#include "spikeloop/experiment/endpoints.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "spikeloop/command/mapping.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/record/playback.hpp"

namespace spikeloop::experiment {

std::vector<std::string> sensor_fields(const Parameters& parameters) {
  const std::string& text = parameters.text("fields");
  if (text.empty()) {
    return {};
  }
  if (text.starts_with('{')) {
    throw ConfigurationError(
        parameters.where("fields"),
        fmt::format("key 'fields': '{}' is no list; write  fields: [pose.pose.position.x]", text));
  }
  if (!text.starts_with('[')) {
    return {text};  // a single path
  }
  std::vector<std::string> fields;
  for (const auto& field : nlohmann::json::parse(text)) {
    if (!field.is_string()) {
      throw ConfigurationError(
          parameters.where("fields"),
          fmt::format(
              "key 'fields': {} is no path of a field; write  fields: [pose.pose.position.x]",
              field.dump()));
    }
    fields.push_back(field.get<std::string>());
  }
  return fields;
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
  std::vector<double> values;
  try {
    const auto& catalog =
        messages::Catalog::for_type(messages::Dialect::ros1, parameters.text("message"));
    const std::string type = catalog.full_name(parameters.text("message"));
    std::vector<std::string> fields = sensor_fields(parameters);
    if (fields.empty() && type == "sensor_msgs/LaserScan") {
      fields = {"ranges"};
    } else if (fields.empty() && type == "std_msgs/Float64MultiArray") {
      fields = {"data"};
    }
    for (const std::string& field : fields) {
      messages::FieldReader(catalog, type, field).read(message, values);
    }
  } catch (const Error&) {
    return 0;  // told elsewhere
  }
  return static_cast<std::uint32_t>(values.size());
}

std::unique_ptr<Source> playback(const Part& part) {
  const std::string& file = part.parameters.text("file");
  const std::string& stream = part.parameters.text("stream");
  return located_at(part.where, [&] {
    return part.kind == kSpikePlayback ? record::make_spike_playback(file, stream)
                                       : record::make_signal_playback(file, stream);
  });
}

void check_command_fields(const CommandMapping& mapping) {
  const auto& catalog = messages::Catalog::for_type(messages::Dialect::ros1, mapping.message_type);
  for (const CommandField& field : mapping.fields) {
    located_at(field.where, [&] {
      return messages::MessageWriter(catalog, mapping.message_type, {field.field}), 0;
    });
  }
  messages::MessageWriter(catalog, mapping.message_type, command::field_paths(mapping));
}

}  // namespace spikeloop::experiment
