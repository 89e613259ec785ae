#include "spikeloop/experiment/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
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

bool crosses(const Experiment& experiment, const Link& link) {
  return process_of(experiment, node_of(link.from)) != process_of(experiment, node_of(link.to));
}

std::uint32_t least_delay(const Experiment& experiment, const Link& link) {
  if (!crosses(experiment, link)) {
    return 0;
  }
  const Process* to = find_process(experiment, node_of(link.to));
  return of_kind(to == nullptr ? kIntoSimulator : to->in_cycle ? kIntoCycle : kForward, link.kind);
}

/// The delay that a connection takes when none is written.
std::uint32_t usual_delay(const Experiment& experiment, const Link& link) {
  std::uint32_t delay = least_delay(experiment, link);
  for (const Link& other : experiment.links) {
    if (is_simulator_end(experiment, link.to) && node_of(other.to) == node_of(link.to) &&
        other.kind == link.kind && is_simulator_end(experiment, other.from)) {
      delay = std::max(delay, other.delay_ticks.value_or(0));
    }
  }
  return delay;
}

/// What a command hears of the sensors and spikes behind it.
void add_edges_into(const Experiment& experiment, const Node& command, std::vector<Link>& edges) {
  const auto add = [&](const std::string& from, const std::string& port, PortKind kind,
                       std::uint32_t width, std::uint32_t delay) {
    Link edge{from, fmt::format("{}.{}", command.name, port), kind, width, delay, command.where};
    edge.delay_ticks = std::max(delay, least_delay(experiment, edge));
    edges.push_back(std::move(edge));
  };
  if (const auto upstream = nearest_sensor(experiment, command.name)) {
    // The time at which the data behind a command came takes as long as these data.
    add(upstream->sensor + ".pace", "pace", PortKind::signal, 1, upstream->delay_ticks);
  }
  std::size_t i = 0;
  for (const Node* sensor : sensors_behind(experiment, command.name)) {
    // Without the delay of the data: that a sensor is silent is no matter of how far they are.
    add(sensor->name + ".pace", fmt::format("sensor_{}", i++), PortKind::signal, 1, 0);
  }
  i = 0;
  for (const Link* link : watched_spikes(experiment, command)) {
    add(link->from, fmt::format("spikes_{}", i++), PortKind::spikes, link->width,
        link->delay_ticks.value_or(0));
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
  const bool has_inputs = std::ranges::any_of(experiment.links, [&](const Link& link) {
    return crosses(experiment, link) && process_of(experiment, node_of(link.to)) == process;
  });
  return !has_inputs || experiment.layout.processes.front().name == process;
}

std::vector<Link> edges(const Experiment& experiment) {
  std::vector<Link> result = experiment.links;
  for (const Node& node : experiment.nodes) {
    if (node.kind == kRosCommand) {
      add_edges_into(experiment, node, result);
    }
  }
  return result;
}

const Link* from_simulator(const Experiment& experiment, const std::string& simulator,
                           PortKind kind) {
  const auto found = std::ranges::find_if(experiment.links, [&](const Link& link) {
    return link.kind == kind && node_of(link.to) == simulator &&
           is_simulator_end(experiment, link.from);
  });
  return found == experiment.links.end() ? nullptr : &*found;
}

std::uint32_t music_delay(const Experiment& experiment, const Link& edge) {
  const Link* between = is_simulator_end(experiment, edge.to)
                            ? from_simulator(experiment, node_of(edge.to), edge.kind)
                            : nullptr;
  return between == nullptr ? least_delay(experiment, edge) : between->delay_ticks.value_or(0);
}

std::string format_ticks(std::uint32_t ticks) {
  return fmt::format("{} tick{}", ticks, ticks == 1 ? "" : "s");
}

Experiment with_layout_delays(const Experiment& experiment) {
  Experiment result = experiment;
  for (Link& link : result.links) {
    const std::uint32_t least = least_delay(experiment, link);
    if (link.delay_ticks.value_or(least) < least) {
      const bool fused = experiment.layout.kind == Layout::Kind::fused;
      const char* const instead = fused                        ? ", or use --layout separate"
                                  : !has_simulator(experiment) ? ", or use the fused layout"
                                                               : "";
      throw ConfigurationError(
          link.where,
          fmt::format("{} from '{}' to '{}' take at least {} {}, and here it is {}; write  delay "
                      "{}, {}leave it out{}",
                      link.kind == PortKind::spikes ? "spikes" : "continuous values", link.from,
                      link.to, format_ticks(least),
                      fused ? "in the fused layout" : "between processes",
                      format_ticks(*link.delay_ticks), format_ticks(least),
                      *instead == '\0' ? "or " : "", instead));
    }
    link.delay_ticks = link.delay_ticks.value_or(usual_delay(experiment, link));
  }
  return result;
}

}  // namespace spikeloop::experiment
