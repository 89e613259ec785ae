#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "faults.hpp"
#include "spikeloop/config/network_file.hpp"
#include "spikeloop/config/network_script.hpp"
#include "spikeloop/config/weight_file.hpp"
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
    if (has_topic(part.kind)) {
      read_endpoint(part, directory, dialect_of(experiment.ros));
    }
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
