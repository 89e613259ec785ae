#include <fmt/format.h>

#include "simulation.hpp"
#include "spikeloop/neurons/network.hpp"

namespace spikeloop {

namespace {

class NetworkNode final : public Node {
 public:
  explicit NetworkNode(NetworkFile network)
      : network_(std::move(network)),
        simulation_(network_.resolution == 0 ? neurons::make_offgrid_simulation(network_)
                                             : neurons::make_grid_simulation(network_)) {}

  void step(const Step& step) override {
    const Interval interval = step.interval();
    // The ends of all intervals lie on the grid when the first begin and every length do.
    network_.check_tick(interval.length());
    network_.check_tick(interval.begin);
    const bool listens = step.plain().spike_input_count != 0;
    const std::span<const Spike> input =
        listens ? step.spike_input().spikes : std::span<const Spike>();
    for (const Spike& spike : input) {
      late_ += spike.time_ns <= interval.begin ? 1 : 0;
    }
    emitted_.clear();
    simulation_->advance(interval, input, emitted_);
    spikes_ += emitted_.size();
    step.spike_output().emit(emitted_);
  }

  std::vector<Counter> counters() const override {
    return {{"spikes", spikes_}, {"late_spikes", late_}};
  }

 private:
  const NetworkFile network_;
  std::unique_ptr<neurons::Simulation> simulation_;
  std::vector<Spike> emitted_;
  std::uint64_t spikes_ = 0;
  std::uint64_t late_ = 0;
};

void check_width(const char* port, const char* listed, std::uint32_t width, std::uint32_t wanted,
                 const std::string& path) {
  if (width != wanted) {
    throw ConfigurationError(
        {path, 0, 0}, fmt::format("port '{}' has {} channels, but the {} have {} together; write "
                                  "the same number in the connection and in the network file",
                                  port, width, listed, wanted));
  }
}

std::unique_ptr<Node> create(const NodeSetup& setup) {
  NetworkFile network = read_network_file(setup.parameters.text("network"));
  check_width("in", "input populations", setup.widths.at(0), network.input_width(), network.path);
  if (setup.widths.at(1) == 0) {
    network.output.clear();  // nobody listens
  } else {
    check_width("out", "populations of 'output'", setup.widths[1], network.output_width(),
                network.path);
  }
  return make_network(std::move(network));
}

}  // namespace

std::unique_ptr<Node> make_network(NetworkFile network) {
  return std::make_unique<NetworkNode>(std::move(network));
}

NodeClass network_class() {
  NodeDescription description;
  description.name = "network";
  description.text = "A small network of repeaters and integrate-and-fire neurons from a file";
  description.source = "Rotter & Diesmann 1999, Biol. Cybern. 81:381-402";
  description.ports = {{"in", PortKind::spikes, Direction::input, {}, "The input populations"},
                       {"out", PortKind::spikes, Direction::output, {}, "The file's output list"}};
  ParameterDescription path;
  path.name = "network";
  path.type = ParameterType::text;
  path.text = "Network file (YAML)";
  description.parameters = {path};
  return {std::move(description), create};
}

NodeClass network_class(const NetworkFile& network) {
  NodeClass node_class = network_class();
  auto& ports = node_class.description.ports;
  ports[0].width = WidthRule::fixed(network.input_width());
  ports[1].width = WidthRule::fixed(network.output_width());
  if (network.input_width() == 0) {
    ports.erase(ports.begin());
  }
  node_class.create = [network](const NodeSetup&) { return make_network(network); };
  return node_class;
}

void register_neurons(Registry& registry) {
  registry.add(network_class());
}

}  // namespace spikeloop
