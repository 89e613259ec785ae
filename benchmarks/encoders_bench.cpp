// How many times faster than real time encoders and the decoder are, and what part of the machine's
// memory bandwidth they use. One core, no transport.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "spikeloop/core/node.hpp"
#include "spikeloop/core/registry.hpp"
#include "spikeloop/nodes/register.hpp"

namespace spikeloop {
namespace {

constexpr TimeNs kMs = 1'000'000;

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// What one core reads from memory, bytes/s: the best of five passes over 512 MB.
double memory_bandwidth() {
  static const double bandwidth = [] {
    const std::vector<std::uint64_t> numbers(std::size_t{1} << 26, 1);
    double best = 0;
    for (int pass = 0; pass < 5; ++pass) {
      const auto begin = std::chrono::steady_clock::now();
      std::array<std::uint64_t, 16> sums{};
      for (std::size_t i = 0; i < numbers.size(); i += sums.size()) {
        for (std::size_t lane = 0; lane < sums.size(); ++lane) {
          sums[lane] += numbers[i + lane];
        }
      }
      benchmark::DoNotOptimize(sums);
      best = std::max(best, static_cast<double>(numbers.size() * 8) / seconds_since(begin));
    }
    return best;
  }();
  return bandwidth;
}

/// An encoder and four inputs that take turns.
class Run {
 public:
  Run(const std::string& name, std::uint32_t dimensions, std::uint32_t neurons,
      const WrittenValues& written)
      : neurons_(neurons) {
    Registry registry;
    register_nodes(registry);
    const NodeClass& node_class = registry.find(name);
    node_ = node_class.create({"bench",
                               1,
                               resolve(node_class.description.parameters, written, {}),
                               {dimensions, neurons}});
    std::mt19937_64 generator(1);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (auto& values : inputs_) {
      values.resize(dimensions);
      std::ranges::generate(values, [&] { return uniform(generator); });
    }
    input_ = {inputs_[0].data(), 0, dimensions, 0};
    output_ = {this, &Run::append, neurons, 0};
  }

  /// 50 ms, which begin with a change of all inputs.
  void twentieth(TimeNs tick) {
    input_.values = inputs_[++input_.revision % inputs_.size()].data();
    for (TimeNs passed = 0; passed < 50 * kMs; passed += tick) {
      const spikeloop_step data{time_, time_ + tick, &input_, nullptr, nullptr, &output_, 1, 0, 0,
                                1};
      node_->step(Step(data));
      time_ += tick;
    }
  }

  /// Counters of a benchmark whose iterations are a twentieth of a second each and read so many
  /// bytes of memory at least.
  void report(benchmark::State& state, double bytes) const {
    const auto simulated_s = static_cast<double>(state.iterations()) * 0.05;
    state.counters["real_time_factor"] =
        benchmark::Counter(simulated_s, benchmark::Counter::kIsRate);
    state.counters["mean_rate_Hz"] = static_cast<double>(spikes_) / neurons_ / to_seconds(time_);
    state.counters["limit_by_memory"] = 0.05 * memory_bandwidth() / bytes;
  }

 private:
  static void append(void* self, const Spike* spikes, std::uint64_t count) {
    auto& run = *static_cast<Run*>(self);
    run.spikes_ += count;
    benchmark::DoNotOptimize(spikes);
  }

  std::uint32_t neurons_;
  std::unique_ptr<Node> node_;
  std::array<std::vector<double>, 4> inputs_;
  spikeloop_signal_input input_{};
  spikeloop_spike_output output_{};
  TimeNs time_ = 0;
  std::uint64_t spikes_ = 0;
};

/// Neurons at 1 to 2 Hz, all inputs changing 20 times a second. range: neurons, tick in ms.
void rate_coded(benchmark::State& state, const char* name) {
  const auto neurons = static_cast<std::uint32_t>(state.range(0));
  Run run(name, neurons, neurons, {{"rate_min", {"1", {}}}, {"rate_max", {"2", {}}}});
  run.twentieth(kMs);
  for (auto _ : state) {
    run.twentieth(state.range(1) * kMs);
  }
  // A change reads input, rate and state, and writes the last two.
  run.report(state, 40.0 * neurons);
}
BENCHMARK_CAPTURE(rate_coded, rate, "rate_encoder")
    ->ArgNames({"neurons", "tick_ms"})
    ->Args({1'000'000, 1})
    ->Args({10'000'000, 50})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(rate_coded, poisson, "poisson_encoder")
    ->ArgNames({"neurons", "tick_ms"})
    ->Args({1'000'000, 1})
    ->Args({10'000'000, 50})
    ->Unit(benchmark::kMillisecond);

/// A million neurons at 20 Hz, 1 ms tick, 20 changes a second. range: dimensions.
void nef(benchmark::State& state) {
  constexpr std::uint32_t kNeurons = 1'000'000;
  const auto dimensions = static_cast<std::uint32_t>(state.range(0));
  Run run("nef_encoder", dimensions, kNeurons,
          {{"max_rate_low", {"40", {}}},
           {"max_rate_high", {"80", {}}},
           {"radius", {std::to_string(0.9), {}}},
           {"intercept_low", {"-0.9", {}}},
           {"intercept_high", {"0.9", {}}}});
  run.twentieth(kMs);
  for (auto _ : state) {
    run.twentieth(kMs);
  }
  // A change reads the directions, reads the neurons and writes most of them.
  run.report(state, (4.0 * dimensions + 28 + 20) * kNeurons);
}
BENCHMARK(nef)->ArgName("dimensions")->Arg(1)->Arg(16)->Arg(100)->Unit(benchmark::kMillisecond);

/// Spikes of 100,000 neurons onto two outputs. range: spikes a tick of 1 ms.
void decoder(benchmark::State& state) {
  constexpr std::uint32_t kNeurons = 100'000;
  const auto count = static_cast<std::size_t>(state.range(0));
  Registry registry;
  register_nodes(registry);
  const NodeClass& node_class = registry.find("linear_readout");
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> weights(std::size_t{2} * kNeurons);
  std::ranges::generate(weights, [&] { return uniform(generator); });
  const auto load = [&](const WrittenValue&) { return WeightTable::dense(2, kNeurons, weights); };
  const auto node = node_class.create(
      {"bench",
       1,
       resolve(node_class.description.parameters, {{"weights", {"table", {}}}}, load),
       {kNeurons, 2}});
  std::vector<Spike> spikes(count);
  for (std::size_t i = 0; i < count; ++i) {
    // As a simulator with a resolution of 0.1 ms gives them, in order of time.
    spikes[i] = make_spike(static_cast<TimeNs>(10 * i / count + 1) * kMs / 10,
                           static_cast<std::int32_t>(generator() % kNeurons));
  }
  std::array<double, 2> values{};
  spikeloop_signal_output output{values.data(), 0, 2, 0};
  TimeNs time = 0;
  for (auto _ : state) {
    const spikeloop_spike_input input{spikes.data(), count, kNeurons, 0};
    const spikeloop_step data{time, time + kMs, nullptr, &input, &output, nullptr, 0, 1, 1, 0};
    node->step(Step(data));
    benchmark::DoNotOptimize(values);
    state.PauseTiming();
    for (Spike& spike : spikes) {
      spike.time_ns += kMs;
    }
    time += kMs;
    state.ResumeTiming();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
  // 16 bytes a spike from memory; the weights fit into a cache.
  state.counters["limit_by_memory"] = memory_bandwidth() / 16;
}
BENCHMARK(decoder)->ArgName("spikes")->Arg(10'000)->Arg(1'000'000);

}  // namespace
}  // namespace spikeloop
