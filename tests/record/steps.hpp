// Calls a sink as a graph would.
#pragma once

#include <vector>

#include "spikeloop/core/endpoint.hpp"

namespace spikeloop::test {

inline void send_spikes(Sink& sink, Interval interval, const std::vector<Spike>& spikes) {
  const spikeloop_spike_input input{spikes.data(), spikes.size(), 0, 0};
  spikeloop_step step{};
  step.begin_ns = interval.begin;
  step.end_ns = interval.end;
  step.spike_inputs = &input;
  step.spike_input_count = 1;
  sink.send(Step(step));
}

inline void send_signal(Sink& sink, Interval interval, const std::vector<double>& values,
                        std::uint64_t revision) {
  const spikeloop_signal_input input{values.data(), revision,
                                     static_cast<std::uint32_t>(values.size()), 0};
  spikeloop_step step{};
  step.begin_ns = interval.begin;
  step.end_ns = interval.end;
  step.signal_inputs = &input;
  step.signal_input_count = 1;
  sink.send(Step(step));
}

/// The k-th interval of 1 ms.
inline Interval tick(TimeNs k) {
  return {k * 1'000'000, (k + 1) * 1'000'000};
}

/// The only spike of the k-th interval in the doomed process's stream.
inline Spike nth_spike(TimeNs k) {
  return make_spike(k * 1'000'000 + 1 + k % 1000, static_cast<std::int32_t>(k % 7));
}

}  // namespace spikeloop::test
