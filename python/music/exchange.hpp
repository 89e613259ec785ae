// What a script's ticks read and write, as the two ends of graphs that lead to MUSIC's ports.
#pragma once

#include <span>
#include <vector>

#include "spikeloop/core/endpoint.hpp"

namespace spikeloop::python {

/// Keeps what has arrived for the tick: the end of every input.
class Inbox : public Sink {
 public:
  explicit Inbox(std::vector<EndpointPort> ports);
  std::vector<EndpointPort> ports() const override { return ports_; }
  void send(const Step& step) override;

  /// Of the i-th spike input: sorted, late ones first.
  const std::vector<Spike>& spikes(std::size_t i) const { return spikes_.at(i); }
  struct Value {
    std::vector<double> values;
    std::uint64_t revision = 0;  ///< 0: none yet
  };
  /// Of the i-th signal input.
  const Value& signal(std::size_t i) const { return signals_.at(i); }

 private:
  std::vector<EndpointPort> ports_;
  std::vector<std::vector<Spike>> spikes_;
  std::vector<Value> signals_;
};

/// Brings out what the script has put into it during the tick: the begin of every output.
class Outbox : public Source {
 public:
  explicit Outbox(std::vector<EndpointPort> ports);
  std::vector<EndpointPort> ports() const override { return ports_; }
  void receive(const Step& step) override;

  std::vector<Spike>& spikes(std::size_t i) { return spikes_.at(i); }
  void write(std::size_t i, std::span<const double> values);

 private:
  struct Value {
    std::vector<double> values;
    bool written = false;
  };
  std::vector<EndpointPort> ports_;
  std::vector<std::vector<Spike>> spikes_;
  std::vector<Value> signals_;
};

}  // namespace spikeloop::python
