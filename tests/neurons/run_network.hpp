// Runs a network node outside of any process.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "spikeloop/neurons/network.hpp"

namespace spikeloop::test {

using Spikes = std::vector<Spike>;

inline constexpr TimeNs kMs = 1'000'000;

/// Nanoseconds of a time in ms.
inline TimeNs ms(double time) {
  return from_seconds(time * 1e-3);
}

inline NetworkFile parse(const std::string& text, const NetworkWeightLoader& load = {}) {
  return parse_network(text, "net.yaml", load);
}

/// (time, channel) pairs, which GoogleTest can compare and print.
inline std::vector<std::pair<TimeNs, int>> plain(const Spikes& spikes) {
  std::vector<std::pair<TimeNs, int>> list;
  for (const Spike& spike : spikes) {
    list.emplace_back(spike.time_ns, spike.channel);
  }
  return list;
}

/// A node with its ports, stepped by hand.
class Runner {
 public:
  Runner(const NetworkFile& network, TimeNs tick)
      : tick_(tick),
        in_width_(network.input_width()),
        out_width_(network.output_width()),
        node_(make_network(network)) {}

  /// One tick with these spikes at port `in`; returns what came out, sorted.
  Spikes step(Spikes input) {
    std::sort(input.begin(), input.end(), spike_before);
    Spikes emitted;
    spikeloop_spike_input in{input.data(), input.size(), in_width_, 0};
    spikeloop_spike_output out{&emitted, &append, out_width_, 0};
    const spikeloop_step data{now_, now_ + tick_, nullptr, &in, nullptr, &out, 0, 1, 0, 1};
    node_->step(Step(data));
    for (const Spike& spike : emitted) {
      inside_ = inside_ && spike.time_ns > now_ && spike.time_ns <= now_ + tick_;
    }
    now_ += tick_;
    std::sort(emitted.begin(), emitted.end(), spike_before);
    return emitted;
  }

  std::uint64_t counter(const std::string& name) const {
    for (const Counter& counter : node_->counters()) {
      if (counter.name == name) {
        return counter.value;
      }
    }
    throw std::out_of_range(name);
  }

  TimeNs now() const { return now_; }
  /// Whether every spike was stamped inside its interval.
  bool inside() const { return inside_; }

 private:
  static void append(void* sink, const spikeloop_spike* spikes, std::uint64_t count) {
    auto& list = *static_cast<Spikes*>(sink);
    list.insert(list.end(), spikes, spikes + count);
  }

  TimeNs tick_;
  std::uint32_t in_width_;
  std::uint32_t out_width_;
  std::unique_ptr<Node> node_;
  TimeNs now_ = 0;
  bool inside_ = true;
};

/// The spikes of port `out` up to `duration`, the input handed over in its own interval.
inline Spikes run(const NetworkFile& network, Spikes input, TimeNs duration, TimeNs tick = kMs) {
  std::sort(input.begin(), input.end(), spike_before);
  Runner runner(network, tick);
  Spikes all;
  std::size_t next = 0;
  while (runner.now() < duration) {
    Spikes now;
    while (next < input.size() && input[next].time_ns <= runner.now() + tick) {
      now.push_back(input[next++]);
    }
    const Spikes emitted = runner.step(now);
    all.insert(all.end(), emitted.begin(), emitted.end());
  }
  if (!runner.inside()) {
    throw std::logic_error("a spike was stamped outside its interval");
  }
  return all;
}

}  // namespace spikeloop::test
