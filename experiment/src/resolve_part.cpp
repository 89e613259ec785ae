#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "faults.hpp"
#include "spikeloop/config/message_type.hpp"
#include "spikeloop/config/network_file.hpp"
#include "spikeloop/config/network_script.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/neurons/network.hpp"
#include "spikeloop/record/reader.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::experiment {
namespace {

using Json = nlohmann::ordered_json;

/// Tables that are written in place, or stand in a file.
WeightLoader table_loader(const std::string& directory, const NodeClass& node_class) {
  WeightOptions options;
  options.base_directory = directory;
  const auto is_grid = [](const auto& parameter) { return parameter.name == "grid"; };
  if (std::ranges::any_of(node_class.description.parameters, is_grid)) {
    options.what = "grid file";
    options.short_forms = false;
  }
  return [options, from_file = weight_loader(options)](const WrittenValue& written) {
    return is_in_place(written.text) ? parse_weights(written.text, "", options)
                                     : from_file(written);
  };
}

/// What a field of `fields` has besides its channel.
Json& field_of(Json& fields, const Parameters::Entry& entry, const char* key) {
  if (!fields.contains(entry.key)) {
    throw ConfigurationError(
        entry.where, fmt::format("key '{}': '{}' is not one of the fields; write it into  fields, "
                                 "too",
                                 key, entry.key));
  }
  return fields[entry.key];
}

/// `limits` as "min" and "max" of its fields.
void add_limits(const Parameters& parameters, Json& fields) {
  for (const Parameters::Entry& entry : parameters.entries("limits")) {
    const auto& range = entry.values.numbers(kAnyKey);
    if (range[0] > range[1]) {
      throw ConfigurationError(
          entry.where, fmt::format("key 'limits': [{}, {}] of '{}' is no least and greatest value; "
                                   "write  {}: [-0.5, 0.5]",
                                   range[0], range[1], entry.key, entry.key));
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
          fmt::format("key 'slew': {} of '{}' is no rate of change; write a number above 0, as  "
                      "{}: 1.0, in units a second",
                      rate, entry.key, entry.key));
    }
    field_of(fields, entry, "slew")["slew"] = rate;
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
  }
  return fields;
}

CommandMapping command_mapping(const Parameters& parameters) {
  Json mapping{{"message_type", parameters.text("message")}};
  Json fields = mapped_fields(parameters);
  add_limits(parameters, fields);
  add_slew(parameters, fields);
  if (!fields.empty()) {
    mapping["mapping"] = fields;
  } else if (parameters.text("message") != "std_msgs/Float64MultiArray") {
    throw ConfigurationError(
        parameters.where("message"),
        fmt::format("key 'fields' is missing: a {} has to know which channel is which; write for "
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

/// The whole name of a type that has a definition, or the whole path of its own.
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

void check_name(const Parameters& parameters, const char* key, messages::Dialect ros,
                const std::string& topic) {
  try {
    topics::check_topic(ros, topic);
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(parameters.where(key), fmt::format("key '{}': {}", key, error.what()));
  }
}

/// Names and times that a transport would refuse.
void check_transport(const Part& part, messages::Dialect ros) {
  check_name(part.parameters, "topic", ros, part.parameters.text("topic"));
  for (const ParameterDescription& parameter : part.node_class->description.parameters) {
    if (parameter.unit == "s") {
      located_at(part.parameters.where(parameter.name),
                 [&] { return from_seconds(part.parameters.number(parameter.name)); });
    }
  }
  if (part.kind == kRosCommand) {
    const std::string stop = emergency_stop(part, ros).topic;
    const std::string manual = manual_override(part).topic;
    if (!stop.empty()) {
      check_name(part.parameters, "emergency_stop", ros, stop);
    }
    if (!manual.empty()) {
      check_name(part.parameters, "override", ros, manual);
    }
  }
}

void check_endpoint(Part& part, const std::string& directory, messages::Dialect ros) {
  const auto canonical = [&] {
    const Location where = part.parameters.where("message");
    const std::string type = located_at(
        where, [&] { return whole_message_type(part.parameters.text("message"), directory, ros); });
    part.parameters.set("message", type, true, where);
  };
  if (part.kind == kRosSensor) {
    canonical();
    sensor_initial(part.parameters);
    sensor_rule(part.parameters);
  } else if (part.kind == kRosEventSensor) {
    canonical();
    event_settings(part.parameters);
  } else if (part.kind == kRosCommand) {
    canonical();
    part.mapping = command_mapping(part.parameters);
    check_command_fields(part.mapping, ros);
  }
  if (has_topic(part.kind)) {
    check_transport(part, ros);
  }
}

/// A network that was written as a map, which is JSON by now: YAML as well. Its places are lost.
NetworkFile network_in_place(const std::string& text, const Location& where,
                             const std::string& directory) {
  try {
    NetworkFile network = parse_network(text, "", [&](const std::string& weights) {
      return read_weights(weights, {.base_directory = directory, .short_forms = false});
    });
    network.path = where.file;
    network.resolution_where = where;
    return network;
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(where, fmt::format("key 'network': {}", reason_of(error)));
  }
}

/// A network's ports are as wide as its file says.
void read_network(Part& part, const std::string& directory, Experiment& experiment) {
  const Location where = part.parameters.where("network");
  const std::string& written = part.parameters.text("network");
  const bool in_place = written.starts_with('{');
  if (!in_place) {
    const std::string path = in_directory(directory, written);
    if (!std::filesystem::exists(network_source(path))) {
      refuse_file("network", where, "network file", network_source(path));
    }
    part.parameters.set("network", path, true, where);
  }
  const std::string& path = part.parameters.text("network");
  const NetworkFile network = in_place ? network_in_place(path, where, directory)
                                       : located_at(where, [&] { return read_network_file(path); });
  network.check_tick(experiment.tick);
  experiment.own_classes.push_back(std::make_shared<NodeClass>(network_class(network)));
  part.node_class = experiment.own_classes.back().get();
}

/// A recording knows its width.
void read_recording(Part& part, const std::string& directory, Experiment& experiment) {
  const Location where = part.parameters.where("file");
  const std::string path = in_directory(directory, part.parameters.text("file"));
  part.parameters.set("file", path, true, where);
  if (!std::filesystem::exists(path)) {
    refuse_file("file", where, "recording", path);
  }
  const std::string& stream = part.parameters.text("stream");
  const Location& named = part.parameters.given("stream") ? part.parameters.where("stream") : where;
  const std::uint32_t width = located_at(named, [&] {
    return part.kind == kSpikePlayback ? record::read_spikes(path, stream).width
                                       : record::read_signal(path, stream).width;
  });
  auto own = std::make_shared<NodeClass>(*part.node_class);
  own->description.ports.front().width = WidthRule::fixed(width);
  part.node_class = own.get();
  experiment.own_classes.push_back(std::move(own));
}

/// The node's class: `node: NAME`, or the simulator of `simulator: NAME`, of which builtin is the
/// built-in network.
std::string kind_of(const ExperimentNode& node, Part& part) {
  const auto take = [&](const char* key) {
    WrittenValue value = node.keys.at(key);
    part.written.erase(key);
    return value;
  };
  if (node.keys.contains("node") == node.keys.contains("simulator")) {
    throw ConfigurationError(
        node.where,
        fmt::format("node '{}' says {}; write  node: rate_encoder, or  simulator: builtin",
                    node.name,
                    node.keys.contains("node") ? "both 'node' and 'simulator'"
                                               : "neither 'node' nor 'simulator'"));
  }
  if (node.keys.contains("node")) {
    return take("node").text;
  }
  return simulator_kind(node, take("simulator"));
}

}  // namespace

std::string in_directory(const std::string& directory, const std::string& path) {
  const std::filesystem::path written(path);
  return written.is_absolute() ? path : (std::filesystem::path(directory) / written).string();
}

void refuse_file(const char* key, const Location& where, const char* what,
                 const std::string& path) {
  throw ConfigurationError(
      where, fmt::format("key '{}': there is no {} '{}'; write its path, from where this file lies",
                         key, what, path));
}

Checked resolve_part(const ExperimentNode& node, const Kinds& kinds, const std::string& directory,
                     Experiment& experiment, Faults& faults) {
  Part part;
  part.name = node.name;
  part.where = node.where;
  part.written = node.keys;
  const bool by_class = node.keys.contains("node");
  const bool found = faults.attempt(node.where, [&] {
    part.kind = kind_of(node, part);
    if (!by_class && part.kind != kNetwork) {
      return;
    }
    const auto written = node.keys.find("node");
    const Location where = written == node.keys.end() ? node.where : written->second.where;
    if (kinds.may_lack(part.kind)) {
      return;
    }
    part.node_class = located_at(where, [&] { return &kinds.find(part.kind); });
    part.role = kinds.role(part.kind);
    part.plugin = kinds.plugin_of(part.kind);
  });
  if (found && !by_class && part.kind != kNetwork) {
    return resolve_simulator(node, std::move(part), directory, experiment, faults);
  }
  if (!found || part.node_class == nullptr) {
    return {};
  }
  const std::size_t before = faults.count();
  part.parameters = resolve_keys(
      part.node_class->description.parameters,
      {part.written, fmt::format("node '{}'", node.name), node.where, node.unread, node.places},
      table_loader(directory, *part.node_class), faults);
  bool good = faults.count() == before && node.unread.empty();
  good = good && faults.attempt(node.where, [&] {
    check_endpoint(part, directory, dialect_of(experiment.ros));
    if (part.kind == kNetwork) {
      read_network(part, directory, experiment);
    } else if (part.kind == kSpikePlayback || part.kind == kSignalPlayback) {
      read_recording(part, directory, experiment);
    }
  });
  const bool own_widths =
      part.kind == kNetwork || part.kind == kSpikePlayback || part.kind == kSignalPlayback;
  const bool ports = good || !own_widths;
  experiment.parts.push_back(std::move(part));
  return {ports, good};
}

}  // namespace spikeloop::experiment
