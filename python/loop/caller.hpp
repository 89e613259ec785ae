// A caller who runs the simulators of an experiment by hand, and what he sees of the other nodes.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/fused/other_processes.hpp"

namespace spikeloop::python {

/// What an output put out, or a simulator's input got.
struct Seen {
  PortKind kind = PortKind::signal;
  std::uint32_t width = 0;
  std::vector<Spike> spikes{};   ///< since they were cleared
  std::vector<double> values{};  ///< the newest; empty: none yet
};

/// Spikes and values for the graph, from an output of a simulator.
struct Sent {
  PortKind kind = PortKind::signal;
  std::uint32_t width = 0;
  std::vector<Spike> spikes{};  ///< of the tick that has passed
  std::vector<double> values{};
  bool is_new = false;
};

class Caller : public fused::OtherProcesses {
 public:
  explicit Caller(const experiment::Experiment& experiment) : experiment_(experiment) {}

  /// A simulator takes a tick: what it answers to an interval arrives in the next one.
  std::uint32_t delay(const experiment::Connection& edge) const override;
  /// @throws ConfigurationError for a connection without a delay.
  std::unique_ptr<Source> source(const experiment::Connection& edge) override;
  std::unique_ptr<Sink> sink(const experiment::Connection& edge) override;
  void meet() override {}
  void exchange() override {}

  /// As fused::RunOptions::observe.
  std::unique_ptr<Sink> observe(const std::string& end, PortKind kind, std::uint32_t width);

  void forget_spikes();
  /// @throws ConfigurationError with "did you mean".
  const Seen& seen(const std::string& end) const;
  Sent& sent(const std::string& end);
  const std::map<std::string, Seen>& all_seen() const { return seen_; }
  const std::map<std::string, Sent>& all_sent() const { return sent_; }

 private:
  const experiment::Experiment& experiment_;
  std::map<std::string, Seen> seen_;  ///< by end: "encoder.out", "brain.in"
  std::map<std::string, Sent> sent_;  ///< "brain.out"
};

}  // namespace spikeloop::python
