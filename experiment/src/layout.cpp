#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "faults.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/experiment/simulators.hpp"

namespace spikeloop::experiment {
namespace {

/// What MUSIC takes between two processes. Around a cycle its latencies have to add up to a tick a
/// process (docs/architecture.md, "Delays between processes").
struct Least {
  std::uint32_t spikes;
  std::uint32_t signals;
};
constexpr Least kForward{0, 1};
constexpr Least kIntoCycle{1, 3};
constexpr Least kIntoSimulator{0, 2};
// More would let a process run further ahead of one that is stuck.
constexpr std::uint32_t kMostSpikeDelay = 2;

std::uint32_t of_kind(const Least& least, PortKind kind) {
  return kind == PortKind::spikes ? least.spikes : least.signals;
}

/// Null for a simulator.
const Process* find_process(const Experiment& experiment, const std::string& node) {
  const auto& processes = experiment.layout.processes;
  const auto found = std::ranges::find_if(
      processes, [&](const Process& process) { return process.nodes.contains(node); });
  return found == processes.end() ? nullptr : &*found;
}

bool crosses(const Experiment& experiment, const Connection& connection) {
  return process_of(experiment, node_of(connection.from)) !=
         process_of(experiment, node_of(connection.to));
}

std::uint32_t least_delay(const Experiment& experiment, const Connection& connection) {
  if (!crosses(experiment, connection)) {
    return 0;
  }
  const Process* to = find_process(experiment, node_of(connection.to));
  return of_kind(to == nullptr  ? kIntoSimulator
                 : to->in_cycle ? kIntoCycle
                                : kForward,
                 connection.kind);
}

/// The delay that a connection takes when none is written.
std::uint32_t usual_delay(const Experiment& experiment, const Connection& connection) {
  std::uint32_t delay = least_delay(experiment, connection);
  for (const Connection& other : experiment.connections) {
    if (is_simulator_end(experiment, connection.to) &&
        node_of(other.to) == node_of(connection.to) && other.kind == connection.kind &&
        is_simulator_end(experiment, other.from)) {
      delay = std::max(delay, other.delay_ticks.value_or(0));
    }
  }
  return delay;
}

/// Every process's `spike_delay`, of delays that are final.
void set_spike_delays(Experiment& experiment) {
  std::map<std::string, std::uint32_t> shortest;
  for (const Connection& edge : edges(experiment)) {
    if (edge.kind == PortKind::spikes && crosses(experiment, edge)) {
      const std::uint32_t delay = edge.delay_ticks.value_or(0);
      const auto [known, first] =
          shortest.try_emplace(process_of(experiment, node_of(edge.to)), delay);
      known->second = std::min(known->second, delay);
    }
  }
  for (Process& process : experiment.layout.processes) {
    if (process.in_cycle) {
      const auto known = shortest.find(process.name);
      process.spike_delay =
          known == shortest.end() ? kIntoCycle.spikes : std::min(known->second, kMostSpikeDelay);
    }
  }
}

/// What a command hears of the sensors and spikes behind it.
void add_edges_into(const Experiment& experiment, const Node& command,
                    std::vector<Connection>& edges) {
  const auto add = [&](const std::string& from, const std::string& port, PortKind kind,
                       std::uint32_t width, std::uint32_t delay) {
    Connection edge{from,         fmt::format("{}.{}", command.name, port), kind, width, delay,
                    command.where};
    edge.delay_ticks = std::max(delay, least_delay(experiment, edge));
    edges.push_back(std::move(edge));
  };
  if (const auto upstream = nearest_sensor(experiment, command.name)) {
    // The time at which the data behind a command came takes as long as these data.
    add(upstream->sensor + ".data_stamp", "data_stamp", PortKind::signal, 1, upstream->delay_ticks);
  }
  std::size_t i = 0;
  for (const Node* sensor : sensors_behind(experiment, command.name)) {
    // Without the delay of the data: that a sensor is silent is no matter of how far they are.
    add(sensor->name + ".data_stamp", fmt::format("sensor_{}", i++), PortKind::signal, 1, 0);
  }
  i = 0;
  for (const Connection* connection : watched_spikes(experiment, command)) {
    add(connection->from, fmt::format("spikes_{}", i++), PortKind::spikes, connection->width,
        connection->delay_ticks.value_or(0));
  }
}

}  // namespace

std::string name_of(const Layout& layout) {
  if (layout.kind != Layout::Kind::written) {
    return layout.kind == Layout::Kind::separate ? "separate" : "fused";
  }
  std::string names;
  for (const Process& process : layout.processes) {
    names += (names.empty() ? "" : ", ") + process.name;
  }
  return names;
}

std::string process_of(const Experiment& experiment, const std::string& node) {
  const Process* process = find_process(experiment, node);
  return process == nullptr ? node : process->name;
}

bool needs_music(const Experiment& experiment) {
  return has_simulator(experiment) || experiment.layout.processes.size() > 1;
}

bool meets_robot(const Experiment& experiment, const std::string& process) {
  bool any = false;
  for (const Node& node : experiment.nodes) {
    any = any || has_topic(node.kind);
    if (has_topic(node.kind) && process_of(experiment, node.name) == process) {
      return true;
    }
  }
  return !any && experiment.layout.processes.front().name == process;
}

bool one_meets_robot(const Experiment& experiment) {
  return std::ranges::count_if(experiment.layout.processes, [&](const Process& process) {
           return meets_robot(experiment, process.name);
         }) == 1;
}

bool waits_for_clock(const Experiment& experiment, const std::string& process) {
  if (experiment.sync == Sync::sim_time) {
    return meets_robot(experiment, process);
  }
  // Spikes alone do not hold up their sender.
  const bool has_inputs =
      std::ranges::any_of(experiment.connections, [&](const Connection& connection) {
        return crosses(experiment, connection) &&
               process_of(experiment, node_of(connection.to)) == process;
      });
  return !has_inputs || experiment.layout.processes.front().name == process;
}

std::vector<Connection> edges(const Experiment& experiment) {
  std::vector<Connection> result = experiment.connections;
  for (const Node& node : experiment.nodes) {
    if (node.kind == kRosCommand) {
      add_edges_into(experiment, node, result);
    }
  }
  return result;
}

const Connection* from_simulator(const Experiment& experiment, const std::string& simulator,
                                 PortKind kind) {
  const auto found =
      std::ranges::find_if(experiment.connections, [&](const Connection& connection) {
        return connection.kind == kind && node_of(connection.to) == simulator &&
               is_simulator_end(experiment, connection.from);
      });
  return found == experiment.connections.end() ? nullptr : &*found;
}

std::uint32_t music_delay(const Experiment& experiment, const Connection& edge) {
  const Connection* between = is_simulator_end(experiment, edge.to)
                                  ? from_simulator(experiment, node_of(edge.to), edge.kind)
                                  : nullptr;
  if (between != nullptr) {
    return between->delay_ticks.value_or(0);
  }
  const Process* to = find_process(experiment, node_of(edge.to));
  const bool late = edge.kind == PortKind::spikes && to != nullptr && crosses(experiment, edge);
  return late ? to->spike_delay : least_delay(experiment, edge);
}

std::string format_ticks(std::uint32_t ticks) {
  return fmt::format("{} tick{}", ticks, ticks == 1 ? "" : "s");
}

Experiment with_layout_delays(const Experiment& experiment) {
  Experiment result = experiment;
  for (Connection& connection : result.connections) {
    const std::uint32_t least = least_delay(experiment, connection);
    if (connection.delay_ticks.value_or(least) < least) {
      const bool fused = experiment.layout.kind == Layout::Kind::fused;
      const char* const instead = has_simulator(experiment) ? "" : ", or use the fused layout";
      throw ConfigurationError(
          connection.where,
          with_code(Code::delay,
                    "{} from '{}' to '{}' take at least {} {}, and here it is {}; write  delay "
                    "{}, {}leave it out{}",
                    connection.kind == PortKind::spikes ? "spikes" : "continuous values",
                    connection.from, connection.to, format_ticks(least),
                    fused ? "in the fused layout" : "between processes",
                    format_ticks(*connection.delay_ticks), format_ticks(least),
                    *instead == '\0' ? "or " : "", instead));
    }
    connection.delay_ticks = connection.delay_ticks.value_or(usual_delay(experiment, connection));
  }
  set_spike_delays(result);
  return result;
}

}  // namespace spikeloop::experiment
