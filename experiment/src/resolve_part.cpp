#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "faults.hpp"
#include "spikeloop/config/message_type.hpp"
#include "spikeloop/config/network_file.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/neurons/network.hpp"

namespace spikeloop::experiment {
namespace {

using Json = nlohmann::ordered_json;

/// Simulators that issues to come bring; their names are no slips.
constexpr const char* kLater[] = {"nest", "neuron", "brian2", "music"};

std::string in_directory(const std::string& directory, const std::string& path) {
  const std::filesystem::path written(path);
  return written.is_absolute() ? path : (std::filesystem::path(directory) / written).string();
}

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
    const bool in_place = written.text.starts_with('[') || written.text.starts_with('{');
    return in_place ? parse_weights(written.text, "", options) : from_file(written);
  };
}

/// What a message says behind its place.
std::string reason_of(const Error& error) {
  const std::string text = error.what();
  const std::size_t place = error.located() ? error.where().text().size() + 2 : 0;
  return text.substr(std::min(place, text.size()));
}

Json parsed(const Parameters& parameters, const char* key, const char* example) {
  const std::string& text = parameters.text(key);
  if (text.empty()) {
    return nullptr;
  }
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object()) {
    throw ConfigurationError(
        parameters.where(key),
        fmt::format("key '{}': '{}' is no map; write  {}: {}", key, text, key, example));
  }
  return json;
}

/// `limits` as "min" and "max" of its fields.
void add_limits(const Parameters& parameters, Json& fields) {
  const Json limits = parsed(parameters, "limits", "{linear.x: [-0.5, 0.5]}");
  if (limits.is_null()) {
    return;
  }
  for (const auto& [field, range] : limits.items()) {
    if (!fields.is_object() || !fields.contains(field)) {
      throw ConfigurationError(
          parameters.where("limits"),
          fmt::format("key 'limits': '{}' is not one of the fields; write it into  fields, too",
                      field));
    }
    if (!range.is_array() || range.size() != 2) {
      throw ConfigurationError(
          parameters.where("limits"),
          fmt::format("key 'limits': {} of '{}' is no pair of numbers; write  {}: [-0.5, 0.5]",
                      range.dump(), field, field));
    }
    if (!fields[field].is_object()) {
      fields[field] = Json{{"channel", fields[field]}};
    }
    fields[field]["min"] = range[0];
    fields[field]["max"] = range[1];
  }
}

CommandMapping command_mapping(const Parameters& parameters) {
  Json mapping{{"message_type", parameters.text("message")}};
  Json fields = parsed(parameters, "fields", "{linear.x: 0, angular.z: 1}");
  add_limits(parameters, fields);
  if (!fields.is_null()) {
    mapping["mapping"] = fields;
  }
  const bool about_fields = parameters.given("fields");
  const Location where = parameters.where(about_fields ? "fields" : "message");
  try {
    CommandMapping result = parse_mapping(mapping.dump(), "");
    for (CommandField& field : result.fields) {
      field.where = where;
    }
    return result;
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(where, reason_of(error));
  }
}

void check_endpoint(Part& part) {
  const auto canonical = [&] {
    const Location where = part.parameters.where("message");
    const std::string type =
        located_at(where, [&] { return canonical_message_type(part.parameters.text("message")); });
    part.parameters.set("message", type, true, where);
  };
  if (part.kind == kRosSensor) {
    if (part.parameters.text("fields").empty()) {
      canonical();
    }
    sensor_initial(part.parameters);
    sensor_fields(part.parameters);
  } else if (part.kind == kRosCommand) {
    canonical();
    part.mapping = command_mapping(part.parameters);
    check_command_fields(part.mapping);
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
    part.parameters.set("network", in_directory(directory, written), true, where);
  }
  const std::string& path = part.parameters.text("network");
  const NetworkFile network = in_place ? network_in_place(path, where, directory)
                                       : located_at(where, [&] { return read_network_file(path); });
  network.check_tick(experiment.tick);
  experiment.own_classes.push_back(std::make_shared<NodeClass>(network_class(network)));
  part.node_class = experiment.own_classes.back().get();
}

void absolute_files(Part& part, const std::string& directory) {
  if (part.kind == kSpikePlayback || part.kind == kSignalPlayback) {
    const Location where = part.parameters.where("file");
    part.parameters.set("file", in_directory(directory, part.parameters.text("file")), true, where);
  }
}

/// The node's class: `node: NAME`, or `simulator: builtin` for the built-in network.
std::string kind_of(const ExperimentNode& node, Part& part) {
  const auto take = [&](const char* key) {
    const WrittenValue value = node.keys.at(key);
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
  const WrittenValue simulator = take("simulator");
  if (simulator.text == "builtin") {
    return kNetwork;
  }
  const bool later = std::ranges::find(kLater, simulator.text) != std::end(kLater);
  throw ConfigurationError(
      simulator.where,
      fmt::format("node '{}': simulator '{}' is {}; write  simulator: builtin, or couple it by a "
                  ".music file",
                  node.name, simulator.text,
                  later ? "not in this version of experiment files" : "unknown"));
}

}  // namespace

bool resolve_part(const ExperimentNode& node, const Kinds& kinds, const std::string& directory,
                  Experiment& experiment, Faults& faults) {
  Part part;
  part.name = node.name;
  part.where = node.where;
  part.written = node.keys;
  const bool found = faults.attempt(node.where, [&] {
    part.kind = kind_of(node, part);
    const auto written = node.keys.find("node");
    const Location where = written == node.keys.end() ? node.where : written->second.where;
    part.node_class = located_at(where, [&] { return &kinds.find(part.kind); });
    part.role = kinds.role(part.kind);
    part.plugin = kinds.plugin_of(part.kind);
  });
  if (!found) {
    return false;
  }
  const bool good = faults.attempt(node.where, [&] {
    part.parameters = resolve_keys(part.node_class->description.parameters, part.written,
                                   table_loader(directory, *part.node_class),
                                   fmt::format("node '{}'", node.name), node.where);
    absolute_files(part, directory);
    check_endpoint(part);
    if (part.kind == kNetwork) {
      read_network(part, directory, experiment);
    }
  });
  experiment.parts.push_back(std::move(part));
  return good;
}

}  // namespace spikeloop::experiment
