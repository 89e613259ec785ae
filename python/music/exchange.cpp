#include "exchange.hpp"

#include <algorithm>
#include <utility>

namespace spikeloop::python {
namespace {

std::size_t count(const std::vector<EndpointPort>& ports, PortKind kind) {
  return static_cast<std::size_t>(std::ranges::count(ports, kind, &EndpointPort::kind));
}

}  // namespace

Inbox::Inbox(std::vector<EndpointPort> ports)
    : ports_(std::move(ports)),
      spikes_(count(ports_, PortKind::spikes)),
      signals_(count(ports_, PortKind::signal)) {}

void Inbox::send(const Step& step) {
  for (std::size_t i = 0; i < spikes_.size(); ++i) {
    const SpikeInput input = step.spike_input(i);
    spikes_[i].assign(input.spikes.begin(), input.spikes.end());
  }
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const SignalInput input = step.signal_input(i);
    if (input.revision != signals_[i].revision) {
      signals_[i] = {{input.values.begin(), input.values.end()}, input.revision};
    }
  }
}

Outbox::Outbox(std::vector<EndpointPort> ports)
    : ports_(std::move(ports)),
      spikes_(count(ports_, PortKind::spikes)),
      signals_(count(ports_, PortKind::signal)) {}

void Outbox::write(std::size_t i, std::span<const double> values) {
  signals_.at(i) = {{values.begin(), values.end()}, true};
}

void Outbox::receive(const Step& step) {
  for (std::size_t i = 0; i < spikes_.size(); ++i) {
    step.spike_output(i).emit(spikes_[i]);
    spikes_[i].clear();
  }
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    if (std::exchange(signals_[i].written, false)) {
      const SignalOutput output = step.signal_output(i);
      std::ranges::copy(signals_[i].values, output.values().begin());
      output.commit();
    }
  }
}

}  // namespace spikeloop::python
