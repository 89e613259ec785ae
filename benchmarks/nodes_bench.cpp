// What readout and connect cost: time per tick of 1 ms, and spikes or products per second.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "spikeloop/core/node.hpp"
#include "spikeloop/core/registry.hpp"
#include "spikeloop/nodes/register.hpp"

namespace spikeloop {
namespace {

constexpr TimeNs kTick = 1'000'000;

std::unique_ptr<Node> make_node(const std::string& name, std::vector<std::uint32_t> widths,
                                const WrittenValues& written = {},
                                const WeightTable& weights = {}) {
  Registry registry;
  register_nodes(registry);
  const NodeClass& node_class = registry.find(name);
  const auto load = [&](const WrittenValue& value) {
    return value.text == "uniform" ? WeightTable::uniform() : weights;
  };
  return node_class.create(
      {"bench", 1, resolve(node_class.description.parameters, written, load), std::move(widths)});
}

std::vector<double> random_values(std::size_t count) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> values(count);
  for (double& value : values) {
    value = uniform(generator);
  }
  return values;
}

// One port of each kind and direction, as far as a node has them.
struct Ports {
  spikeloop_signal_input signal_in{};
  spikeloop_spike_input spike_in{};
  spikeloop_signal_output signal_out{};
  spikeloop_spike_output spike_out{};
  std::vector<Spike> emitted;
  TimeNs time = 0;

  static void append(void* self, const Spike* spikes, std::uint64_t count) {
    auto& emitted = static_cast<Ports*>(self)->emitted;
    emitted.insert(emitted.end(), spikes, spikes + count);
  }

  void step(Node& node) {
    emitted.clear();
    spike_out.sink = this;
    spike_out.append = &append;
    const spikeloop_step data{
        time, time + kTick, &signal_in, &spike_in, &signal_out, &spike_out, 1, 1, 1, 1};
    node.step(Step(data));
    time += kTick;
  }
};

// A readout of 100,000 neurons with range(0) spikes a tick onto range(1) outputs.
void linear_readout(benchmark::State& state) {
  constexpr std::uint32_t kNeurons = 100'000;
  const auto outputs = static_cast<std::uint32_t>(state.range(1));
  const auto count = static_cast<std::size_t>(state.range(0));
  const auto node = make_node(
      "linear_readout", {kNeurons, outputs}, {{"weights", {"table", {}}}},
      WeightTable::dense(outputs, kNeurons, random_values(std::size_t{kNeurons} * outputs)));
  std::mt19937_64 generator(2);
  std::vector<double> values(outputs);
  std::vector<TimeNs> offsets(count);
  for (std::size_t i = 0; i < count; ++i) {
    offsets[i] = static_cast<TimeNs>((i + 1) * static_cast<std::size_t>(kTick) / count);
  }
  std::vector<Spike> spikes(count);
  for (Spike& spike : spikes) {
    spike = make_spike(0, static_cast<std::int32_t>(generator() % kNeurons));
  }
  Ports ports;
  ports.signal_out = {values.data(), 0, outputs, 0};
  ports.spike_in = {spikes.data(), count, kNeurons, 0};
  for (auto _ : state) {
    for (std::size_t i = 0; i < count; ++i) {
      spikes[i].time_ns = ports.time + offsets[i];
    }
    ports.step(*node);
    benchmark::DoNotOptimize(values.data());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(linear_readout)
    ->ArgNames({"spikes", "outputs"})
    ->ArgsProduct({{0, 100, 10'000}, {2, 100}});

// range(0) inputs to range(1) outputs, dense or a tenth of it.
void connect(benchmark::State& state, double density) {
  const auto columns = static_cast<std::uint32_t>(state.range(0));
  const auto rows = static_cast<std::uint32_t>(state.range(1));
  std::vector<double> weights = random_values(std::size_t{rows} * columns);
  for (double& weight : weights) {
    weight = (weight + 1) / 2 < density ? weight : 0.0;
  }
  WeightTable table = WeightTable::dense(rows, columns, weights);
  const auto node = make_node("connect", {columns, rows}, {{"weights", {"table", {}}}},
                              density < 1.0 ? table.compressed() : table);
  const std::vector<double> input = random_values(columns);
  std::vector<double> output(rows);
  Ports ports;
  ports.signal_in = {input.data(), 0, columns, 0};
  ports.signal_out = {output.data(), 0, rows, 0};
  for (auto _ : state) {
    ++ports.signal_in.revision;
    ports.step(*node);
    benchmark::DoNotOptimize(output.data());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(static_cast<double>(state.iterations()) * rows *
                                                    columns * density));
}
BENCHMARK_CAPTURE(connect, dense, 1.0)->Args({100, 2})->Args({1000, 100})->Args({10'000, 100});
BENCHMARK_CAPTURE(connect, sparse_tenth, 0.1)->Args({1000, 100})->Args({10'000, 100});

}  // namespace
}  // namespace spikeloop
