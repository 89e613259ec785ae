// Nodes that are simulators: their script, their parameters, and their ports, which the connections
// say.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "faults.hpp"
#include "spikeloop/config/script_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/experiment/simulators.hpp"

namespace spikeloop::experiment {
namespace {

constexpr const char* kScript = "script";
constexpr const char* kProcesses = "np";

constexpr const char* kParallel = "neuron";
constexpr const char* kRounding = "nest";

bool is_own(const std::string& key) {
  return key == kScript || key == kProcesses;
}

ScriptHost host_of(const std::string& path, const Location& where) {
  try {
    return host_in_script(path);
  } catch (const FileError& error) {
    throw FileError(where, with_code(Code::script,
                                     "key 'script': {}; write the path of a file that you can "
                                     "read, or let yourself read it (chmod u+r)",
                                     error.what()));
  }
}

void read_script(Node& node, const Simulator& simulator, const std::string& directory) {
  const Location where = node.parameters.where(kScript);
  const std::string path = in_directory(directory, node.parameters.text(kScript));
  if (!std::filesystem::is_regular_file(path)) {
    refuse_file(kScript, where, "script", path);
  }
  const ScriptHost host = host_of(path, where);
  if (host == ScriptHost::nest && node.kind != kRounding) {
    throw ConfigurationError(
        where, with_code(Code::script,
                         "key 'script': '{}' imports spikeloop.nest, whose times are rounded; "
                         "write  simulator: {}",
                         path, kRounding));
  }
  if (host == ScriptHost::none) {
    throw ConfigurationError(
        where, with_code(Code::script,
                         "key 'script': '{}' does not take part in an experiment; write  import "
                         "{}  into it (docs/simulators.md)",
                         path, simulator.host));
  }
  node.parameters.set(kScript, path, true, where);
}

/// Whatever else is written goes to the script, which knows its own parameters.
void take_parameters(const ExperimentNode& entry, Node& node, Faults& faults) {
  for (const auto& [name, value] : node.written) {
    if (is_own(name)) {
      continue;
    }
    check_parameter_name(entry, name, faults);
    node.parameters.set(name, value.text, true, value.where);
  }
}

/// What another node says of a port that a connection joins with one of ours; none: it is not
/// known.
const PortDescription* port_at(const Experiment& experiment, const std::string& end,
                               Direction direction) {
  const auto node = std::ranges::find(experiment.nodes, node_of(end), &Node::name);
  if (node == experiment.nodes.end() || is_simulator(*node)) {
    return nullptr;
  }
  const auto& ports = node->node_class->description.ports;
  const auto find = [&](std::string_view name) {
    return std::ranges::find_if(ports, [&](const PortDescription& port) {
      return port.direction == direction && (name.empty() || port.name == name);
    });
  };
  if (end.find('.') != std::string::npos) {
    const auto named = find(port_of(end));
    return named == ports.end() ? nullptr : &*named;
  }
  const auto usual = find(usual_port(direction));
  const auto found = usual == ports.end() ? find("") : usual;
  return found == ports.end() ? nullptr : &*found;
}

/// Ports from the connections: a name, a direction, and the kind that the other end has. Between
/// two simulators nobody knows that: it is spikes.
class PortFinder {
 public:
  PortFinder(const ExperimentFile& file, const Experiment& experiment, Faults& faults)
      : file_(file), experiment_(experiment), faults_(faults) {}

  std::vector<PortDescription> ports_of(const Node& node) {
    ports_.clear();
    for (const ExperimentConnection& connection : file_.connections) {
      if (node_of(connection.to) == node.name) {
        add(node, connection.to, Direction::input, connection.from, connection.where);
      }
      if (node_of(connection.from) == node.name) {
        add(node, connection.from, Direction::output, connection.to, connection.where_from);
      }
    }
    return ports_;
  }

 private:
  void add(const Node& node, const std::string& end, Direction direction, const std::string& other,
           const Location& where) {
    const bool input = direction == Direction::input;
    const std::string name = port_of(end);
    const auto* const beyond =
        port_at(experiment_, other, input ? Direction::output : Direction::input);
    const auto known = std::ranges::find(ports_, name, &PortDescription::name);
    if (known == ports_.end()) {
      ports_.push_back(
          {name, beyond == nullptr ? PortKind::spikes : beyond->kind, direction, {}, ""});
      unknown_ = beyond == nullptr;
    } else if (known->direction != direction) {
      faults_.add(where, with_code(Code::script,
                                   "'{0}.{1}' is an input here and an output there, and MUSIC "
                                   "has one port of a name; give the script's two ports two "
                                   "names",
                                   node.name, name));
    } else if (unknown_ && beyond != nullptr) {
      known->kind = beyond->kind;
    }
  }

  const ExperimentFile& file_;
  const Experiment& experiment_;
  Faults& faults_;
  std::vector<PortDescription> ports_;
  bool unknown_ = false;
};

/// "brain" as the end of a connection is "brain.in", or "brain.out".
void complete(std::string& end, std::string_view port, const Experiment& experiment) {
  const auto node = std::ranges::find(experiment.nodes, end, &Node::name);
  if (node != experiment.nodes.end() && is_simulator(*node)) {
    end += fmt::format(".{}", port);
  }
}

/// MUSIC joins no program to itself.
void refuse_itself(ExperimentConnection& connection, const Experiment& experiment, Faults& faults) {
  if (node_of(connection.from) != node_of(connection.to) ||
      !is_simulator_end(experiment, connection.to)) {
    return;
  }
  faults.add(connection.where,
             with_code(Code::script,
                       "'{}' is connected to '{}' of the same script; connect its cells within "
                       "the script, or put another node between its ports",
                       connection.from, connection.to));
  if (connection.delay.text.empty()) {
    connection.delay = {"1 tick", connection.where};  // not told once more, as a cycle without
  }
}

}  // namespace

void check_parameter_name(const ExperimentNode& entry, const std::string& name, Faults& faults) {
  const auto place = entry.places.find(name);
  if (std::ranges::find(reserved_keys(), std::string_view(name)) != reserved_keys().end()) {
    faults.add(place == entry.places.end() ? entry.keys.at(name).where : place->second,
               with_code(Code::invalid_name,
                         "node '{}': '{}' is the name of a key of every program, and no "
                         "parameter of a script; give it another name",
                         entry.name, name));
  }
}

std::string simulator_kind(const ExperimentNode& entry, const WrittenValue& written) {
  constexpr const char* kBuiltin = "builtin";
  if (written.text == kBuiltin) {
    return kNetwork;
  }
  if (find_simulator(written.text) != nullptr) {
    return written.text;
  }
  std::vector<std::string> names{kBuiltin};
  for (const Simulator& simulator : simulators()) {
    names.emplace_back(simulator.name);
  }
  throw ConfigurationError(
      written.where, with_code(Code::unknown_simulator, "node '{}': simulator '{}' is unknown{}",
                               entry.name, written.text, did_you_mean(written.text, names)));
}

Checked resolve_simulator(const ExperimentNode& entry, Node node, const std::string& directory,
                          Experiment& experiment, Faults& faults) {
  const Simulator& simulator = *find_simulator(node.kind);
  node.role = Role::simulator;
  node.node_class = nullptr;
  const std::size_t before = faults.count();
  WrittenValues own = node.written;
  std::erase_if(own, [](const auto& key) { return !is_own(key.first); });
  node.parameters = resolve_keys(
      simulator_description().parameters,
      {own, fmt::format("node '{}'", entry.name), entry.where, entry.unread, entry.places}, {},
      faults);
  if (faults.count() == before && entry.unread.empty()) {
    faults.attempt(entry.where, [&] { read_script(node, simulator, directory); });
  }
  if (node.parameters.integer(kProcesses) > 1 && node.kind != kParallel) {
    faults.add(node.parameters.where(kProcesses),
               with_code(Code::out_of_bounds,
                         "key 'np': {} processes are for NEURON's ParallelContext; a script with "
                         "simulator: {} has one: leave the key out",
                         node.parameters.integer(kProcesses), node.kind));
  }
  take_parameters(entry, node, faults);
  const bool good = faults.count() == before && entry.unread.empty();
  experiment.nodes.push_back(std::move(node));
  return {true, good};
}

ExperimentFile with_simulator_ports(const ExperimentFile& file, Experiment& experiment,
                                    Faults& faults) {
  ExperimentFile result = file;
  for (ExperimentConnection& connection : result.connections) {
    complete(connection.from, usual_port(Direction::output), experiment);
    complete(connection.to, usual_port(Direction::input), experiment);
    refuse_itself(connection, experiment, faults);
  }
  PortFinder finder(result, experiment, faults);
  for (Node& node : experiment.nodes) {
    if (is_simulator(node)) {
      NodeClass own{simulator_description(), {}};
      own.description.name = node.kind;
      own.description.ports = finder.ports_of(node);
      experiment.own_classes.push_back(std::make_shared<NodeClass>(std::move(own)));
      node.node_class = experiment.own_classes.back().get();
    }
  }
  return result;
}

}  // namespace spikeloop::experiment
