#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "simulation.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/neurons/network.hpp"

namespace spikeloop {

namespace {

// A projection's learned weights as a table that `rule` reads: one row a target.
WeightTable table_of(const NetworkFile& network, const NetworkProjection& projection,
                     std::span<const double> learned) {
  WeightTable table;
  table.kind = WeightTable::Kind::sparse;
  table.rows = network.populations[projection.to].size;
  table.columns = network.populations[projection.from].size;
  table.row_start.assign(std::size_t{table.rows} + 1, 0);
  for (const std::uint32_t target : projection.target) {
    ++table.row_start[target + 1];
  }
  std::partial_sum(table.row_start.begin(), table.row_start.end(), table.row_start.begin());
  table.column.resize(projection.target.size());
  table.values.resize(projection.target.size());
  std::vector<std::uint64_t> next(table.row_start.begin(), table.row_start.end() - 1);
  for (std::uint32_t source = 0; source < table.columns; ++source) {  // ascending within a row
    for (std::uint64_t k = projection.row_start[source]; k < projection.row_start[source + 1];
         ++k) {
      const std::uint64_t place = next[projection.target[k]]++;
      table.column[place] = source;
      table.values[place] = learned[k];
    }
  }
  return table;
}

class NetworkNode final : public Node {
 public:
  NetworkNode(NetworkFile network, const neurons::Seeding& seeding)
      : network_(std::move(network)),
        seeding_(seeding),
        simulation_(network_.resolution == 0 ? neurons::make_offgrid_simulation(network_, seeding)
                                             : neurons::make_grid_simulation(network_, seeding)),
        signal_(network_.signal_width(), 0.0),
        emitted_(1 + static_cast<std::size_t>(std::ranges::count_if(
                         network_.record, [](const auto& entry) { return entry.spikes; }))) {}

  void step(const Step& step) override {
    const Interval interval = step.interval();
    // The ends of all intervals lie on the grid when the first begin and every length do.
    network_.check_tick(interval.length());
    network_.check_grid(interval.begin);
    const bool listens = step.plain().spike_input_count != 0;
    const std::span<const Spike> input =
        listens ? step.spike_input().spikes : std::span<const Spike>();
    for (const Spike& spike : input) {
      late_ += spike.time_ns <= interval.begin ? 1 : 0;
    }
    take_signal(step);
    for (auto& list : emitted_) {
      list.clear();
    }
    simulation_->advance(interval, input, emitted_);
    spikes_ += emitted_[0].size();
    put_spikes(step);
    put_values(step);
  }

  std::vector<Counter> counters() const override {
    return {{"spikes", spikes_}, {"late_spikes", late_}};
  }

  /// A new simulation with the weights of the old one.
  void reset(TimeNs now) override {
    for (std::size_t i = 0; i < network_.projections.size(); ++i) {
      const auto learned = simulation_->learned(i);
      if (!learned.empty()) {
        network_.projections[i].weight.assign(learned.begin(), learned.end());
      }
    }
    simulation_ = neurons::make_grid_simulation(network_, seeding_, now);
    if (revision_ != 0) {
      simulation_->set_signal(signal_, now);
    }
  }

  std::vector<LearningWeights> learning_weights() const override {
    std::vector<LearningWeights> all;
    for (std::size_t i = 0; i < network_.projections.size(); ++i) {
      const NetworkProjection& projection = network_.projections[i];
      if (const auto weights = simulation_->learned_so_far(i); !weights.empty()) {
        const auto name = fmt::format("{}.{}", network_.populations[projection.from].name,
                                      network_.populations[projection.to].name);
        const auto same = std::ranges::count_if(
            all, [&](const LearningWeights& other) { return other.name.starts_with(name); });
        all.push_back({same == 0 ? name : fmt::format("{}_{}", name, same + 1), weights});
      }
    }
    return all;
  }

  std::vector<Result> results() override {
    std::vector<Result> all;
    for (std::size_t i = 0; i < network_.projections.size(); ++i) {
      const NetworkProjection& projection = network_.projections[i];
      if (projection.plasticity && !projection.plasticity->save.empty()) {
        all.push_back(
            {projection.plasticity->save, table_of(network_, projection, simulation_->learned(i))});
      }
    }
    return all;
  }

 private:
  // No value yet, or none any more: no current flows.
  void take_signal(const Step& step) {
    if (signal_.empty() || step.plain().signal_input_count == 0 ||
        step.signal_input().revision == revision_) {
      return;
    }
    const SignalInput input = step.signal_input();
    revision_ = input.revision;
    for (std::size_t i = 0; i < signal_.size(); ++i) {
      const double value = input.valid() ? input.values[i] : 0.0;
      if (std::isinf(value)) {
        throw std::runtime_error(
            fmt::format("port 'signal': channel {} is {}; send finite numbers", i, value));
      }
      signal_[i] = std::isnan(value) ? 0.0 : value;
    }
    simulation_->set_signal(signal_, step.interval().begin);
  }

  // Port `out` is there when somebody is on it; those of recorded spikes stand behind it.
  void put_spikes(const Step& step) {
    std::size_t port = 0;
    if (step.plain().spike_output_count >= emitted_.size()) {
      step.spike_output(port++).emit(emitted_[0]);
    }
    for (std::size_t list = 1; list < emitted_.size(); ++list) {
      step.spike_output(port++).emit(emitted_[list]);
    }
  }

  void put_values(const Step& step) {
    std::size_t port = 0;
    for (const auto* const list : {&network_.potential, &network_.rates}) {
      if (list->empty()) {
        continue;
      }
      const SignalOutput output = step.signal_output(port++);
      std::size_t channel = 0;
      for (const std::size_t population : *list) {
        for (std::uint32_t i = 0; i < network_.populations[population].size; ++i) {
          output.values()[channel++] = simulation_->value(population, i);
        }
      }
      output.commit();
    }
    for (const NetworkRecord& record : network_.record) {
      if (record.potential.empty()) {
        continue;
      }
      const SignalOutput output = step.signal_output(port++);
      if (record.interval != 0 && step.interval().end % record.interval != 0) {
        continue;
      }
      std::size_t channel = 0;
      for (const std::uint32_t member : record.potential) {
        output.values()[channel++] = simulation_->value(record.population, member);
      }
      output.commit();
    }
  }

  NetworkFile network_;
  const neurons::Seeding seeding_;
  std::unique_ptr<neurons::Simulation> simulation_;
  std::vector<double> signal_;
  std::vector<std::vector<Spike>> emitted_;  // port `out`, recorded populations
  std::uint64_t revision_ = 0;
  std::uint64_t spikes_ = 0;
  std::uint64_t late_ = 0;
};

void check_width(const char* port, const char* listed, std::uint32_t width, std::uint32_t wanted,
                 const std::string& path) {
  if (width != wanted) {
    throw ConfigurationError(
        {path, 0, 0}, with_code(Code::widths_differ,
                                "port '{}' has {} channels, but the {} have {} together; write "
                                "the same number in the connection and in the network file",
                                port, width, listed, wanted));
  }
}

// Where the file was not known beforehand; what it records has no ports then.
std::unique_ptr<Node> create(const NodeSetup& setup) {
  NetworkFile network = read_network_file(setup.parameters.text("network"));
  const std::string& path = network.path;
  check_width("in", "input populations", setup.widths.at(0), network.input_width(), path);
  check_width("signal", "populations of model signal_input", setup.widths.at(2),
              network.signal_width(), path);
  network.record.clear();
  if (setup.widths.at(1) == 0) {
    network.output.clear();  // nobody listens
  } else {
    check_width("out", "populations of 'output'", setup.widths[1], network.output_width(), path);
  }
  if (setup.widths.at(3) == 0) {
    network.potential.clear();
  } else {
    check_width("potential", "populations of 'potential'", setup.widths[3],
                network.potential_width(), path);
  }
  if (setup.widths.at(4) == 0) {
    network.rates.clear();
  } else {
    check_width("rates", "populations of 'rates'", setup.widths[4], network.rates_width(), path);
  }
  return make_network(std::move(network), setup.name, setup.seed);
}

constexpr const char* kPotentialUnit = "mV";

Population population_of(const NetworkFile& network, std::size_t index) {
  return {network.populations[index].name, network.populations[index].size};
}

PortDescription port(std::string name, PortKind kind, Direction direction, std::uint32_t width,
                     std::string text) {
  const WidthRule rule = width == 0 ? WidthRule{} : WidthRule::fixed(width);
  return {std::move(name), kind, direction, rule, std::move(text)};
}

}  // namespace

std::unique_ptr<Node> make_network(NetworkFile network, const std::string& name,
                                   std::uint64_t seed) {
  return std::make_unique<NetworkNode>(std::move(network), neurons::Seeding{seed, name});
}

NodeClass network_class() {
  NodeDescription description;
  description.name = "network";
  description.text =
      "Simulates a small network of repeaters, integrate-and-fire and rate neurons from a file";
  description.source = "Rotter & Diesmann 1999, Biol. Cybern. 81:381-402";
  description.ports = {
      port("in", PortKind::spikes, Direction::input, 0, "Input populations"),
      port("out", PortKind::spikes, Direction::output, 0,
           "Populations in the list output of the file"),
      port("signal", PortKind::signal, Direction::input, 0,
           "Populations of model signal_input: currents, rewards"),
      port("potential", PortKind::signal, Direction::output, 0,
           "Membrane potentials in the list potential of the file, mV"),
      port("rates", PortKind::signal, Direction::output, 0, "Rates in the list rates of the file")};
  description.ports[3].unit = kPotentialUnit;
  ParameterDescription path;
  path.name = "network";
  path.type = ParameterType::text;
  path.text = "Network file (YAML), or FILE.py:FUNCTION";
  description.parameters = {path};
  return {std::move(description), create};
}

NodeClass network_class(const NetworkFile& network) {
  NodeClass node_class = network_class();
  node_class.description.reset = network.resolution != 0 ? Reset::by_itself : Reset::never;
  std::vector<PortDescription>& ports = node_class.description.ports;
  ports[0].width = WidthRule::fixed(network.input_width());
  ports[1].width = WidthRule::fixed(network.output_width());
  ports[2].width = WidthRule::fixed(network.signal_width());
  ports[3].width = WidthRule::fixed(network.potential_width());
  ports[4].width = WidthRule::fixed(network.rates_width());
  for (const std::size_t population : network.output) {
    ports[1].populations.push_back(population_of(network, population));
  }
  std::erase_if(ports, [](const PortDescription& listed) { return listed.width.value == 0; });
  for (const NetworkRecord& record : network.record) {
    const NetworkPopulation& population = network.populations[record.population];
    if (record.spikes) {
      ports.push_back(port(population.name + "_spikes", PortKind::spikes, Direction::output,
                           population.size, "Recorded spikes"));
      ports.back().populations = {population_of(network, record.population)};
    }
    if (!record.potential.empty()) {
      ports.push_back(port(population.name + "_V_m", PortKind::signal, Direction::output,
                           static_cast<std::uint32_t>(record.potential.size()),
                           "Recorded membrane potentials, mV"));
      ports.back().unit = kPotentialUnit;
      for (const std::uint32_t member : record.potential) {
        ports.back().channels.push_back(fmt::format("{} {}", population.name, member));
      }
    }
  }
  node_class.create = [network](const NodeSetup& setup) {
    return make_network(network, setup.name, setup.seed);
  };
  return node_class;
}

void register_neurons(Registry& registry) {
  registry.add(network_class());
}

}  // namespace spikeloop
