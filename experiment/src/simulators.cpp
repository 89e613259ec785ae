#include "spikeloop/experiment/simulators.hpp"

#include <algorithm>
#include <array>

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
                               "clock_master",
                               "pace",  // the earlier name of clock_master
                               "rtf",
                               "sync",
                               "stamp_guard",
                               "accept_latency",
                               "signal_delay",
                               "spike_delay",
                               "record",
                               kOnWriteFailureKey,
                               "experiment_file",
                               "spikes_in",
                               "spikes_out",
                               "signals_in",
                               "signals_out"};

NodeDescription description() {
  NodeDescription result;
  result.name = "simulator";
  result.text =
      "Runs a script with neurons of NEST, NEURON, Brian2 or its own, in a separate process";
  result.ports = {{"in", PortKind::spikes, Direction::input, {}, "As declared by the script"},
                  {"out", PortKind::spikes, Direction::output, {}, "As declared by the script"}};
  result.parameters = {{.name = "script",
                        .type = ParameterType::text,
                        .text = "Python file; other keys are its parameters"},
                       {.name = "np",
                        .type = ParameterType::integer,
                        .default_value = "1",
                        .minimum = 1,
                        .maximum = 1000,
                        .text = "Number of processes, for NEURON's ParallelContext"}};
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

bool is_simulator(const Node& node) {
  return node.role == Role::simulator;
}

bool is_simulator_end(const Experiment& experiment, const std::string& end) {
  const auto node = std::ranges::find(experiment.nodes, node_of(end), &Node::name);
  return node != experiment.nodes.end() && is_simulator(*node);
}

bool has_simulator(const Experiment& experiment) {
  return std::ranges::any_of(experiment.nodes, is_simulator);
}

}  // namespace spikeloop::experiment
