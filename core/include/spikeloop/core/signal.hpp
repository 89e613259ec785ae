// C++ views of the plain step data of plugin.h: what a node sees while it advances.
#pragma once

#include <cstdint>
#include <span>
#include <tuple>

#include "spikeloop/core/plugin.h"
#include "spikeloop/core/time.hpp"

namespace spikeloop {

/// A spike: `time_ns` in nanoseconds, 0-based `channel`.
using Spike = spikeloop_spike;

inline Spike make_spike(TimeNs time, std::int32_t channel) {
  return {time, channel, 0};
}

/// The order in which spikes reach a node.
inline bool spike_before(const Spike& a, const Spike& b) {
  return std::tie(a.time_ns, a.channel) < std::tie(b.time_ns, b.channel);
}

/// A continuous input held over the interval; by convention values lie in [-1, 1].
struct SignalInput {
  std::span<const double> values;
  std::uint64_t revision = 0;

  /// False until the first value has come; a node does nothing for an invalid input.
  bool valid() const { return revision != 0; }
};

/// The spikes of the interval, sorted by (time, channel); late ones (time <= begin) stand first.
struct SpikeInput {
  std::span<const Spike> spikes;
  std::uint32_t width = 0;
};

/// A continuous output: write `values()`, then `commit()`. Without commit the signal is unchanged.
class SignalOutput {
 public:
  explicit SignalOutput(spikeloop_signal_output& port) : port_(&port) {}
  std::span<double> values() const { return {port_->values, port_->width}; }
  void commit() const { ++port_->revision; }
  void invalidate() const { port_->revision = 0; }
  std::uint64_t revision() const { return port_->revision; }

 private:
  spikeloop_signal_output* port_;
};

/// Where a node emits spikes, in any order, stamped inside the interval.
class SpikeOutput {
 public:
  explicit SpikeOutput(spikeloop_spike_output& port) : port_(&port) {}
  void emit(TimeNs time, std::int32_t channel) const {
    const Spike spike = make_spike(time, channel);
    port_->append(port_->sink, &spike, 1);
  }
  void emit(std::span<const Spike> spikes) const {
    port_->append(port_->sink, spikes.data(), spikes.size());
  }
  std::uint32_t width() const { return port_->width; }

 private:
  spikeloop_spike_output* port_;
};

/// One call of Node::step. Ports count from 0 within their kind and direction, in the order in
/// which the node's description lists them.
class Step {
 public:
  explicit Step(const spikeloop_step& data) : data_(&data) {}

  Interval interval() const { return {data_->begin_ns, data_->end_ns}; }
  SignalInput signal_input(std::size_t i = 0) const {
    const auto& port = data_->signal_inputs[i];
    return {{port.values, port.width}, port.revision};
  }
  SpikeInput spike_input(std::size_t i = 0) const {
    const auto& port = data_->spike_inputs[i];
    return {{port.spikes, port.count}, port.width};
  }
  SignalOutput signal_output(std::size_t i = 0) const {
    return SignalOutput(data_->signal_outputs[i]);
  }
  SpikeOutput spike_output(std::size_t i = 0) const { return SpikeOutput(data_->spike_outputs[i]); }
  const spikeloop_step& plain() const { return *data_; }

 private:
  const spikeloop_step* data_;
};

}  // namespace spikeloop
