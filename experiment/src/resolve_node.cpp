#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "faults.hpp"
#include "spikeloop/config/network_file.hpp"
#include "spikeloop/config/network_script.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/neurons/network.hpp"
#include "spikeloop/record/reader.hpp"

namespace spikeloop::experiment {
namespace {

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

/// A network that was written as a map, which is JSON by now: YAML as well.
NetworkFile network_in_place(const WrittenValue& written, const std::string& directory) {
  try {
    NetworkFile network = parse_network(written.text, "", [&](const std::string& weights) {
      return read_weights(weights, {.base_directory = directory, .short_forms = false});
    });
    network.path = written.where.file;
    network.resolution_where = place_in_file(written, network.resolution_where);
    for (NetworkRecord& record : network.record) {
      record.where = place_in_file(written, record.where);
    }
    return network;
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(place_in_file(written, error.where()),
                             fmt::format("key 'network': {}", reason_of(error)));
  }
}

/// @throws ConfigurationError when there is no such file
std::string network_path(const WrittenValue& written, const std::string& directory) {
  const std::string path = in_directory(directory, written.text);
  if (!std::filesystem::exists(network_source(path))) {
    refuse_file("network", written.where, "network file", network_source(path));
  }
  return path;
}

/// The Python function that makes a network; none: the network is not one of Python's.
std::optional<NetworkScript> script_of(const Node& node, const std::string& directory) {
  const auto network = node.written.find("network");
  if (node.kind != kNetwork || network == node.written.end() ||
      !is_network_script(network->second.text)) {
    return std::nullopt;
  }
  return located_at(network->second.where,
                    [&] { return NetworkScript(network_path(network->second, directory)); });
}

/// A network's ports are as wide as its file says.
void read_network(Node& node, std::optional<NetworkScript>& script, const std::string& directory,
                  Experiment& experiment) {
  const Location where = node.parameters.where("network");
  const std::string written = node.parameters.text("network");
  const bool in_place = written.starts_with('{');
  if (!in_place) {
    node.parameters.set("network", network_path({written, where}, directory), true, where);
  }
  const std::string& path = node.parameters.text("network");
  const NetworkFile network = in_place ? network_in_place(node.written.at("network"), directory)
                              : script ? script->network(node.parameters)
                                       : located_at(where, [&] { return read_network_file(path); });
  network.check_tick(experiment.tick);
  experiment.own_classes.push_back(std::make_shared<NodeClass>(network_class(network)));
  node.node_class = experiment.own_classes.back().get();
}

/// A recording knows its width.
void read_recording(Node& node, const std::string& directory, Experiment& experiment) {
  const Location where = node.parameters.where("file");
  const std::string path = in_directory(directory, node.parameters.text("file"));
  node.parameters.set("file", path, true, where);
  if (!std::filesystem::exists(path)) {
    refuse_file("file", where, "recording", path);
  }
  const std::string& stream = node.parameters.text("stream");
  const Location& named = node.parameters.given("stream") ? node.parameters.where("stream") : where;
  const std::uint32_t width = located_at(named, [&] {
    return node.kind == kSpikePlayback ? record::read_spikes(path, stream).width
                                       : record::read_signal(path, stream).width;
  });
  auto own = std::make_shared<NodeClass>(*node.node_class);
  own->description.ports.front().width = WidthRule::fixed(width);
  node.node_class = own.get();
  experiment.own_classes.push_back(std::move(own));
}

/// The node's class: `node: NAME`, or the simulator of `simulator: NAME`, of which builtin is the
/// built-in network.
std::string kind_of(const ExperimentNode& entry, Node& node) {
  const auto take = [&](const char* key) {
    WrittenValue value = entry.keys.at(key);
    node.written.erase(key);
    return value;
  };
  const bool both = entry.keys.contains("node");  // when there is a simulator as well
  if (both == entry.keys.contains("simulator")) {
    throw ConfigurationError(
        entry.where,
        with_code(both ? Code::conflicting_keys : Code::missing_key,
                  "node '{}' says {}; write  node: rate_encoder, or  simulator: builtin",
                  entry.name,
                  both ? "both 'node' and 'simulator'" : "neither 'node' nor 'simulator'"));
  }
  if (entry.keys.contains("node")) {
    return take("node").text;
  }
  return simulator_kind(entry, take("simulator"));
}

/// The keys that every node has, whatever its class.
void take_common_keys(const ExperimentNode& entry, Node& node, Faults& faults) {
  WrittenValues common;
  for (const std::string& name : names_of(node_parameters())) {
    if (auto written = node.written.extract(name)) {
      common.insert(std::move(written));
    }
  }
  const Parameters keys = resolve_keys(
      node_parameters(),
      {common, fmt::format("node '{}'", entry.name), entry.where, {}, entry.places}, {}, faults);
  node.record = keys.boolean("record");
}

/// Also those that every node has.
std::set<std::string> keys_of(const NodeClass& node_class) {
  std::set<std::string> keys{"node", "simulator"};
  for (const auto& names :
       {names_of(node_parameters()), names_of(node_class.description.parameters)}) {
    keys.insert(names.begin(), names.end());
  }
  return keys;
}

}  // namespace

std::string in_directory(const std::string& directory, const std::string& path) {
  const std::filesystem::path written(path);
  return written.is_absolute() ? path : (std::filesystem::path(directory) / written).string();
}

void refuse_file(const char* key, const Location& where, const char* what,
                 const std::string& path) {
  throw ConfigurationError(
      where, with_code(Code::missing_file,
                       "key '{}': there is no {} '{}'; write its path, from where this file lies",
                       key, what, path));
}

Checked resolve_node(const ExperimentNode& entry, const NodeTypes& types,
                     const std::string& directory, Experiment& experiment, Faults& faults) {
  Node node;
  node.name = entry.name;
  node.where = entry.where;
  node.written = entry.keys;
  const std::size_t before = faults.count();
  take_common_keys(entry, node, faults);
  const bool by_class = entry.keys.contains("node");
  const bool found = faults.attempt(entry.where, [&] {
    node.kind = kind_of(entry, node);
    if (!by_class && node.kind != kNetwork) {
      return;
    }
    const auto written = entry.keys.find("node");
    const Location where = written == entry.keys.end() ? entry.where : written->second.where;
    if (types.may_lack(node.kind)) {
      return;
    }
    node.node_class = located_at(where, [&] { return &types.find(node.kind); });
    node.role = types.role(node.kind);
    node.plugin = types.plugin_of(node.kind);
  });
  if (found && !by_class && node.kind != kNetwork) {
    return resolve_simulator(entry, std::move(node), directory, experiment, faults);
  }
  if (!found || node.node_class == nullptr) {
    return {};
  }
  std::optional<NetworkScript> script;
  WrittenValues keys = node.written;
  auto declared = node.node_class->description.parameters;
  if (!faults.attempt(entry.where, [&] { script = script_of(node, directory); })) {
    std::erase_if(keys, [](const auto& key) {
      return key.first != "network";
    });  // the function's: not checked
  } else if (script) {
    const std::set<std::string> own_keys = keys_of(*node.node_class);
    for (const ParameterDescription& parameter : script->parameters()) {
      if (own_keys.contains(parameter.name)) {
        faults.add(entry.keys.at("network").where,
                   with_code(Code::invalid_name,
                             "key 'network': the function's argument '{}' has the name of a key of "
                             "the node; give it another name",
                             parameter.name));
        continue;
      }
      declared.push_back(parameter);
      if (keys.contains(parameter.name)) {
        check_parameter_name(entry, parameter.name, faults);
      }
    }
  }
  node.parameters = resolve_keys(
      declared,
      {keys, fmt::format("node '{}'", entry.name), entry.where, entry.unread, entry.places},
      table_loader(directory, *node.node_class), faults);
  bool good = faults.count() == before && entry.unread.empty();
  good = good && faults.attempt(entry.where, [&] {
    if (has_topic(node.kind)) {
      read_endpoint(node, directory, experiment.dialect);
    }
    if (node.kind == kNetwork) {
      read_network(node, script, directory, experiment);
    } else if (node.kind == kSpikePlayback || node.kind == kSignalPlayback) {
      read_recording(node, directory, experiment);
    }
  });
  const bool own_widths =
      node.kind == kNetwork || node.kind == kSpikePlayback || node.kind == kSignalPlayback;
  const bool ports = good || !own_widths;
  experiment.nodes.push_back(std::move(node));
  return {ports, good};
}

}  // namespace spikeloop::experiment
