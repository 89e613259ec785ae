// spikeloop-network: the built-in network as a MUSIC program.
#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "check.hpp"
#include "spikeloop/config/network_script.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/neurons/network.hpp"
#include "spikeloop/process/music_main.hpp"
#include "spikeloop/process/node_program.hpp"

namespace {

using namespace spikeloop;

constexpr const char* kExample =
    "  [network]\n"
    "  binary=spikeloop-network\n"
    "  np=1\n"
    "  network=brain.yaml\n"
    "  encoder.out -> network.in [100]\n"
    "  network.out -> decoder.in [102]\n"
    "\n"
    "brain.yaml (all keys: docs/network-file.md):\n"
    "  resolution: 0.1 ms\n"
    "  populations:\n"
    "    input: {model: input, size: 100}\n"
    "    relay: {model: repeater, size: 100}\n"
    "    motor: {model: iaf_psc_exp, size: 2, parameters: {tau_m: 10 ms, I_e: 300 pA}}\n"
    "  connections:\n"
    "    - {from: input, to: relay, rule: one_to_one, delay: 1 ms}\n"
    "    - {from: relay, to: motor, rule: all_to_all, weight: 100 pA, delay: 1 ms}\n"
    "  output: [relay, motor]\n";

music::ProgramText program_text() {
  music::ProgramText text;
  const NodeDescription description = network_class().description;
  text.name = "spikeloop-network";
  text.summary = description.text;
  text.ports =
      "  in         spikes      Input populations, in the order of the file\n"
      "  signal     continuous  Populations of model signal_input, in the order of the file\n"
      "  out        spikes      Populations in the list `output`, in its order\n"
      "  potential  continuous  Membrane potentials in the list `potential`, mV\n"
      "  rates      continuous  Rates in the list `rates`\n"
      "  NAME_spikes, NAME_V_m  Recorded data of population NAME\n";
  text.parameters = description.parameters;
  text.example = kExample;
  text.notes =
      "spikeloop-network --check FILE.yaml  checks a network file and prints its tables.\n";
  return text;
}

// What a port without channels wants in the file.
std::string lacking(const std::string& port, std::uint32_t width) {
  if (port == "in") {
    return fmt::format("input population; write  in: {{model: input, size: {}}}", width);
  }
  if (port == "signal") {
    return fmt::format(
        "population of model signal_input; write  signal: {{model: signal_input, size: {}}}",
        width);
  }
  const std::string key = port == "out" ? "output" : port;
  return fmt::format("key '{0}'; write  {0}: [NAME]", key);
}

// The connection's width and the file's must be the same; both places are named.
void check_width(const music::Process& process, const std::string& port, std::uint32_t wanted,
                 const NetworkFile& network) {
  const std::uint32_t width = process.width(port);
  if (wanted == 0) {
    throw ConfigurationError(
        process.where(port),
        with_code(Code::unknown_port, "'{}.{}' is connected, but the network {} has no {}",
                  process.label(), port, network.path, lacking(port, width)));
  }
  if (width != wanted) {
    throw ConfigurationError(
        process.where(port),
        with_code(Code::widths_differ,
                  "the connection of '{}.{}' has the width {}, but the network {} has {} "
                  "channels there; write [{}]",
                  process.label(), port, width, network.path, wanted, wanted));
  }
}

void check(const music::Process& process, const NetworkFile& network) {
  network.check_tick(process.common().music_timestep);
  if (process.connected_input("in", PortKind::spikes)) {
    check_width(process, "in", network.input_width(), network);
  }
  if (process.connected_input("signal", PortKind::signal)) {
    check_width(process, "signal", network.signal_width(), network);
  }
  if (process.connected_output("out", PortKind::spikes)) {
    check_width(process, "out", network.output_width(), network);
  }
  if (process.connected_output("potential", PortKind::signal)) {
    check_width(process, "potential", network.potential_width(), network);
  }
  if (process.connected_output("rates", PortKind::signal)) {
    check_width(process, "rates", network.rates_width(), network);
  }
}

/// Of a Python function with the arguments that the section has.
NetworkFile read_network(const music::Process& process, const std::string& path) {
  if (!is_network_script(path)) {
    return read_network_file(path);
  }
  NetworkScript script(path);
  return script.network(process.read(script.parameters()));
}

int body(music::Process& process) {
  const Parameters parameters = process.read(network_class().description.parameters);
  const NetworkFile network = located_at(parameters.where("network"), [&] {
    return read_network(process, parameters.text("network"));
  });
  check(process, network);
  NodeClass node_class = network_class(network);
  const Node* node = nullptr;
  node_class.create = [&](const NodeSetup& setup) {
    auto made = make_network(network, setup.name, setup.seed);
    node = made.get();
    return made;
  };
  music::Process::LoopHooks hooks;
  hooks.summary = [&node] {
    nlohmann::json summary = nlohmann::json::object();
    for (const Counter& counter : node->counters()) {
      if (counter.name == "spikes") {
        summary["spikes"] = counter.value;
      }
    }
    return summary;
  };
  return music::run_node(process, node_class, parameters, hooks);
}

int check_file(const char* path) {
  try {
    std::fputs(describe(read_network_file(path)).c_str(), stdout);
    return 0;
  } catch (const Error& error) {
    std::fprintf(stderr, "spikeloop-network: %s\n", error.what());
    return error.exit_code();
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool asked = argc > 1 && std::string(argv[1]) == "--check";
  if (asked && !music::started_by_music(argc, argv)) {
    if (argc != 3) {
      std::fprintf(stderr,
                   "spikeloop-network: --check takes one file; write  spikeloop-network "
                   "--check FILE.yaml\n");
      return 2;
    }
    return check_file(argv[2]);
  }
  return music::music_main(argc, argv, program_text(), body);
}
