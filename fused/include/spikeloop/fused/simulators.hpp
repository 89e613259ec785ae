// Programs beside this process that some nodes of the experiment run in: what joins them with the
// graph. This room knows of no MPI; whoever has it makes one of these.
#pragma once

#include <memory>

#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::fused {

class Simulators {
 public:
  Simulators() = default;
  Simulators(const Simulators&) = delete;
  Simulators& operator=(const Simulators&) = delete;
  virtual ~Simulators() = default;

  /// The begin of a connection that comes from a simulator, with the one port that this names. What
  /// it brings has the least delay that there is (experiment::least_delay) behind it.
  virtual std::unique_ptr<Source> output(const experiment::Link& link) = 0;
  /// The end of a connection that leads to one.
  virtual std::unique_ptr<Sink> input(const experiment::Link& link) = 0;

  /// All ends have been made: waits until all programs are ready.
  virtual void meet() = 0;
  /// The graph has advanced by a tick, and now they do: waits for their answers to the tick before.
  virtual void exchange() = 0;
};

}  // namespace spikeloop::fused
