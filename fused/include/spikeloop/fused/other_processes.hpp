// What runs nodes of the experiment beside this graph, and how it is joined with it: processes of a
// MUSIC job, or a caller in Python who stands for the simulators.
#pragma once

#include <memory>

#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::fused {

class OtherProcesses {
 public:
  OtherProcesses() = default;
  OtherProcesses(const OtherProcesses&) = delete;
  OtherProcesses& operator=(const OtherProcesses&) = delete;
  virtual ~OtherProcesses() = default;

  /// Whole ticks of an edge's delay that what comes from source(), or goes into sink(), takes
  /// there; the rest waits in the graph.
  virtual std::uint32_t delay(const experiment::Connection& edge) const = 0;
  /// The begin of an edge that comes from another process, with the port that it comes from.
  virtual std::unique_ptr<Source> source(const experiment::Connection& edge) = 0;
  /// The end of an edge that leads to another process: for a simulator with the port that it leads
  /// to; else with the port that it comes from, for all processes that take from this one.
  virtual std::unique_ptr<Sink> sink(const experiment::Connection& edge) = 0;

  /// All ends have been made: waits until all programs are ready.
  virtual void meet() = 0;
  /// The graph has advanced by a tick, and now they do: waits for what they send.
  virtual void exchange() = 0;
};

}  // namespace spikeloop::fused
