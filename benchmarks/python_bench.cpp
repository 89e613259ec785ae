// What a node in Python costs: time per tick of 1 ms at a width, with a new input in every tick.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "spikeloop/core/node.hpp"
#include "spikeloop/core/registry.hpp"

namespace spikeloop {
namespace {

constexpr TimeNs kTick = 1'000'000;

std::unique_ptr<Node> make_node(const std::string& file, const std::string& name,
                                std::uint32_t width) {
  setenv("SPIKELOOP_LIBRARY_PATH", PYTHON_NODES_LIBRARY, 1);
  Registry registry;
  registry.load_plugin(file);
  const NodeClass& node_class = registry.find(name);
  return node_class.create(
      {"bench", 1, resolve(node_class.description.parameters, {}, {}), {width, width}});
}

struct Spikes {
  std::vector<Spike> emitted;
  static void append(void* self, const Spike* spikes, std::uint64_t count) {
    auto& emitted = static_cast<Spikes*>(self)->emitted;
    emitted.insert(emitted.end(), spikes, spikes + count);
  }
};

void run(benchmark::State& state, const std::string& file, const std::string& name, bool changes) {
  const auto width = static_cast<std::uint32_t>(state.range(0));
  const auto node = make_node(file, name, width);
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> input(width);
  for (double& value : input) {
    value = uniform(generator);
  }
  std::vector<double> output(width);
  Spikes spikes;
  spikeloop_signal_input in{input.data(), 1, width, 0};
  spikeloop_signal_output signal_out{output.data(), 0, width, 0};
  spikeloop_spike_output spike_out{&spikes, &Spikes::append, width, 0};
  const bool to_spikes = name != "bench_gain" && name != "bench_idle";
  TimeNs time = 0;
  std::uint64_t count = 0;
  for (auto _ : state) {
    in.revision += changes ? 1 : 0;
    const spikeloop_step data{time,
                              time + kTick,
                              &in,
                              nullptr,
                              &signal_out,
                              &spike_out,
                              1,
                              0,
                              to_spikes ? 0U : 1U,
                              to_spikes ? 1U : 0U};
    node->step(Step(data));
    time += kTick;
    count += spikes.emitted.size();
    spikes.emitted.clear();
  }
  state.counters["spikes/tick"] =
      benchmark::Counter(static_cast<double>(count), benchmark::Counter::kAvgIterations);
}

BENCHMARK_CAPTURE(run, signal_unchanged, BENCH_NODES, "bench_idle", false)->Arg(1000);
BENCHMARK_CAPTURE(run, signal_to_signal, BENCH_NODES, "bench_gain", true)->Arg(1000);
BENCHMARK_CAPTURE(run, signal_to_spikes, BENCH_NODES, "bench_threshold", true)->Arg(1000);
BENCHMARK_CAPTURE(run, example_encoder, EXAMPLE_ENCODER, "my_rate_encoder", true)->Arg(1000);

}  // namespace
}  // namespace spikeloop
