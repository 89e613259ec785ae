// What the keys of a topic's node mean together.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "faults.hpp"
#include "spikeloop/command/mapping.hpp"
#include "spikeloop/config/message_type.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::experiment {
namespace {

using Json = nlohmann::ordered_json;

/// What a field of `fields` has besides its channel.
Json& field_of(Json& fields, const Parameters::Entry& entry, const char* key) {
  if (!fields.contains(entry.key)) {
    std::vector<std::string> known;
    for (const auto& [name, field] : fields.items()) {
      known.push_back(name);
    }
    const std::string meant = nearest(entry.key, known);
    throw ConfigurationError(
        entry.where,
        with_code(Code::field_path,
                  "key '{}': '{}' is not one of the fields; {}write it into  fields, "
                  "too",
                  key, entry.key,
                  meant.empty() ? "" : fmt::format("did you mean '{}'? If not, ", meant)));
  }
  return fields[entry.key];
}

/// `limits` as "min" and "max" of its fields.
void add_limits(const Parameters& parameters, Json& fields) {
  for (const Parameters::Entry& entry : parameters.entries("limits")) {
    const auto& range = entry.values.numbers(kAnyKey);
    if (range[0] > range[1]) {
      throw ConfigurationError(
          entry.where, with_code(Code::wrong_order,
                                 "key 'limits': minimum {0} of '{2}' is greater than maximum {1}; "
                                 "write  {2}: [{1}, {0}]",
                                 range[0], range[1], entry.key));
    }
    Json& field = field_of(fields, entry, "limits");
    field["min"] = range[0];
    field["max"] = range[1];
  }
}

/// `slew` as that of its fields.
void add_slew(const Parameters& parameters, Json& fields) {
  for (const Parameters::Entry& entry : parameters.entries("slew")) {
    const double rate = entry.values.number(kAnyKey);
    if (rate <= 0) {
      throw ConfigurationError(
          entry.where,
          with_code(Code::out_of_bounds,
                    "key 'slew': {} of '{}' is not a rate of change; write a number above 0, as  "
                    "{}: 1.0, in units a second",
                    rate, entry.key, entry.key));
    }
    field_of(fields, entry, "slew")["slew"] = rate;
  }
}

/// @throws ConfigurationError at `where`.
std::string checked_stop(const std::string& value, const Location& where) {
  located_at(where, [&] {
    try {
      return parse_stop(value);
    } catch (const ConfigurationError& error) {
      throw ConfigurationError(fmt::format("key 'stop': {}", error.what()));
    }
  });
  return value;
}

/// A joint cannot be held by its measured position if no positions are received.
void check_measured(const Parameters& parameters, const CommandMapping& mapping) {
  for (const CommandField& field : mapping.fields) {
    if (!field.held_joint().empty() && parameters.text("joint_states") == "none") {
      throw ConfigurationError(
          parameters.where("joint_states"),
          with_code(Code::conflicting_keys,
                    "key 'joint_states' is none, but '{}' holds the measured position of joint "
                    "'{}' at a stop; write the topic of the positions, or  hold  without a name",
                    field.field, field.held_joint()));
    }
  }
}

/// `stop` as that of the mapping and of its fields.
void add_stop_rules(const Parameters& parameters, Json& mapping, Json& fields) {
  if (const std::string all = parameters.word("stop"); !all.empty()) {
    mapping["stop"] = all;
  }
  for (const Parameters::Entry& entry : parameters.entries("stop")) {
    field_of(fields, entry, "stop")["stop"] = checked_stop(entry.values.text(kAnyKey), entry.where);
  }
}

/// `fields` as a mapping file has them.
Json mapped_fields(const Parameters& parameters) {
  Json fields = Json::object();
  for (const auto& [name, where, values] : parameters.entries("fields")) {
    Json& field = fields[name];
    field["channel"] = values.integer("channel");
    for (const char* key : {"scale", "offset", "min", "max", "slew"}) {
      if (values.given(key)) {
        field[key] = values.number(key);
      }
    }
    if (values.given("stop")) {
      field["stop"] = checked_stop(values.text("stop"), values.where("stop"));
    }
  }
  return fields;
}

CommandMapping command_mapping(const Parameters& parameters) {
  Json mapping{{"message_type", parameters.text("message")}};
  Json fields = mapped_fields(parameters);
  add_limits(parameters, fields);
  add_slew(parameters, fields);
  add_stop_rules(parameters, mapping, fields);
  if (!fields.empty()) {
    mapping["mapping"] = fields;
  } else if (parameters.text("message") != "std_msgs/Float64MultiArray") {
    throw ConfigurationError(
        parameters.where("message"),
        with_code(Code::missing_key,
                  "key 'fields' is missing: a {} has to know which channel is which; write for "
                  "example  fields: {{linear.x: 0, angular.z: 1}}",
                  parameters.text("message")));
  }
  const bool about_fields = parameters.given("fields");
  const Location& where = parameters.where(about_fields ? "fields" : "message");
  try {
    CommandMapping result = parse_mapping(mapping.dump(), "");
    const auto& entries = parameters.entries("fields");
    for (CommandField& field : result.fields) {
      const auto entry = std::ranges::find(entries, field.field, &Parameters::Entry::key);
      field.where = entry == entries.end() ? where : entry->where;  // elements of a slice have none
    }
    return result;
  } catch (const ConfigurationError& error) {
    in_yaml([&] { throw ConfigurationError(where, reason_of(error)); });
    throw;  // never reached
  }
}

/// @throws ConfigurationError at the field that the message does not have.
void check_command_fields(const CommandMapping& mapping, messages::Dialect ros) {
  const Location first = mapping.fields.empty() ? Location{} : mapping.fields.front().where;
  const messages::Catalog& catalog =
      *located_at(first, [&] { return &messages::Catalog::for_type(ros, mapping.message_type); });
  for (const CommandField& field : mapping.fields) {
    located_at(field.where, [&] {
      return messages::MessageWriter(catalog, mapping.message_type, {field.field}), 0;
    });
  }
  messages::MessageWriter(catalog, mapping.message_type, command::field_paths(mapping));
}

void check_topic(const Parameters& parameters, const char* key, messages::Dialect ros,
                 const std::string& topic) {
  located_at(parameters.where(key), [&] { topics::check_topic(ros, topic); });
}

/// Names and times that a transport would refuse.
void check_transport(const Node& node, messages::Dialect ros) {
  const Parameters& parameters = node.parameters;
  check_topic(parameters, "topic", ros, parameters.text("topic"));
  for (const ParameterDescription& parameter : node.node_class->description.parameters) {
    if (parameter.unit == "s") {
      located_at(parameters.where(parameter.name),
                 [&] { return from_seconds(parameters.number(parameter.name)); });
    }
  }
  if (node.kind == kRosCommand) {
    const std::pair<const char*, std::string> written[] = {
        {"joint_states", parameters.text("joint_states")},
        {"emergency_stop", emergency_stop(node, ros).topic},
        {"override", manual_override(node).topic}};
    for (const auto& [key, topic] : written) {
      if (!topic.empty() && topic != "none") {
        check_topic(parameters, key, ros, topic);
      }
    }
  }
}

}  // namespace

std::string whole_message_type(const std::string& written, const std::string& directory,
                               messages::Dialect ros) {
  std::string type = written;
  try {
    type = canonical_message_type(written, directory);
  } catch (const ConfigurationError&) {
    if (written.find_first_of("/.") != std::string::npos) {
      throw;
    }
    // A name without its package; the error is that of who knows all of them.
  }
  const auto& catalog = messages::Catalog::for_type(ros, type);
  const std::string name = catalog.full_name(type);
  catalog.layout(name);
  return is_definition_file(type) ? type : name;
}

void read_endpoint(Node& node, const std::string& directory, messages::Dialect ros) {
  if (node.mapping.message_type.empty()) {
    const Location where = node.parameters.where("message");
    const std::string type = located_at(
        where, [&] { return whole_message_type(node.parameters.text("message"), directory, ros); });
    node.parameters.set("message", type, true, where);
  }
  if (node.kind == kRosSensor) {
    sensor_settings(node.parameters);
  } else if (node.kind == kRosEventSensor) {
    event_sensor_settings(node.parameters);
  } else {
    if (node.mapping.message_type.empty()) {
      node.mapping = command_mapping(node.parameters);
      check_measured(node.parameters, node.mapping);
    }
    check_command_fields(node.mapping, ros);
  }
  check_transport(node, ros);
}

}  // namespace spikeloop::experiment
