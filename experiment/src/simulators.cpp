#include "spikeloop/experiment/simulators.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "faults.hpp"

namespace spikeloop::experiment {
namespace {

constexpr std::array kSimulators{
    Simulator{"nest", "spikeloop.nest", "nest",
              "NEST is not in Debian: build it (nest-simulator.readthedocs.io), and let PYTHONPATH "
              "name the place of its Python module"},
    Simulator{"neuron", "spikeloop.neuron", "neuron", "Debian: apt install python3-neuron"},
    Simulator{"brian2", "spikeloop.brian", "brian2", "Debian: apt install python3-brian"},
    Simulator{"python", "spikeloop", "", ""}};

constexpr std::array kReserved{"binary",
                               "args",
                               "wd",
                               "timebase",
                               "node",
                               "simulator",
                               "script",
                               "stoptime",
                               "music_timestep",
                               "barrier",
                               "seed",
                               "dialect",
                               "strict",
                               "pace",
                               "rtf",
                               "sync",
                               "stamp_guard",
                               "accept_latency",
                               "signal_delay",
                               "spike_delay",
                               "record",
                               "experiment_file",
                               "spikes_in",
                               "spikes_out",
                               "signals_in",
                               "signals_out"};

// What MUSIC takes around a cycle, whose latencies have to add up to a tick a process
// (docs/architecture.md, "Simulators beside a fused process").
constexpr std::uint32_t kSpikesBack = 1;
constexpr std::uint32_t kSignalsThere = 2;
constexpr std::uint32_t kSignalsBack = 3;

NodeDescription description() {
  NodeDescription result;
  result.name = "simulator";
  result.text = "A script with neurons of NEST, NEURON, Brian2 or its own, in a process of its own";
  result.ports = {{"in", PortKind::spikes, Direction::input, {}, "As the script declares"},
                  {"out", PortKind::spikes, Direction::output, {}, "As the script declares"}};
  result.parameters = {{.name = "script",
                        .type = ParameterType::text,
                        .text = "A Python file; other keys are its parameters"},
                       {.name = "np",
                        .type = ParameterType::integer,
                        .default_value = "1",
                        .minimum = 1,
                        .maximum = 1000,
                        .text = "Its processes, for NEURON's ParallelContext"}};
  return result;
}

}  // namespace

std::span<const Simulator> simulators() {
  return kSimulators;
}

const Simulator* find_simulator(std::string_view name) {
  const auto* const found =
      std::ranges::find_if(kSimulators, [&](const auto& known) { return name == known.name; });
  return found == kSimulators.end() ? nullptr : found;
}

const NodeDescription& simulator_description() {
  static const NodeDescription described = description();
  return described;
}

std::span<const char* const> reserved_keys() {
  return kReserved;
}

bool is_simulator(const Part& part) {
  return part.role == Role::simulator;
}

bool is_simulator_end(const Experiment& experiment, const std::string& end) {
  const auto part = std::ranges::find(experiment.parts, node_of(end), &Part::name);
  return part != experiment.parts.end() && is_simulator(*part);
}

bool has_simulator(const Experiment& experiment) {
  return std::ranges::any_of(experiment.parts, is_simulator);
}

std::string own_label(const Experiment& experiment) {
  std::string label = "experiment";
  while (std::ranges::any_of(experiment.parts, [&](const Part& part) {
    return is_simulator(part) && part.name == label;
  })) {
    label += '_';
  }
  return label;
}

std::string format_ticks(std::uint32_t ticks) {
  return fmt::format("{} tick{}", ticks, ticks == 1 ? "" : "s");
}

std::uint32_t least_input_delay(PortKind kind) {
  return kind == PortKind::spikes ? 0 : kSignalsThere;
}

std::uint32_t least_delay(const Experiment& experiment, const Link& link) {
  if (is_simulator_end(experiment, link.to)) {
    return least_input_delay(link.kind);
  }
  return !is_simulator_end(experiment, link.from) ? 0
         : link.kind == PortKind::spikes          ? kSpikesBack
                                                  : kSignalsBack;
}

namespace {

/// The delay that a connection takes when none is written: a simulator waits for all of its inputs
/// of a kind as long as for those from another simulator.
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

}  // namespace

Experiment with_fused_delays(const Experiment& experiment) {
  Experiment result = experiment;
  for (Link& link : result.links) {
    const std::uint32_t least = least_delay(experiment, link);
    if (link.delay_ticks.value_or(least) < least) {
      throw ConfigurationError(
          link.where,
          fmt::format("{} from '{}' to '{}' take at least {} in the fused layout, and here it is "
                      "{}; write  delay {}, leave it out, or use --layout separate",
                      link.kind == PortKind::spikes ? "spikes" : "continuous values", link.from,
                      link.to, format_ticks(least), format_ticks(*link.delay_ticks),
                      format_ticks(least)));
    }
    link.delay_ticks = link.delay_ticks.value_or(usual_delay(experiment, link));
  }
  return result;
}

}  // namespace spikeloop::experiment
