// Changes parameters of nodes while a run goes on, and writes that down.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "spikeloop/core/graph.hpp"
#include "spikeloop/core/write_failures.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::fused {

class Changes {
 public:
  /// @param folder of the run, where they are written; empty: nowhere
  /// @param failures receives a failed write
  Changes(const experiment::Experiment& experiment, Graph& graph, std::string folder,
          WriteFailures& failures)
      : experiment_(experiment), graph_(graph), folder_(std::move(folder)), failures_(failures) {}

  /// The changes of a run that is repeated, up to the graph's time. @throws Error as
  /// Graph::change().
  void repeat(const std::function<void(const experiment::Change&)>& made);
  /// Applies the change at the current time of the graph. @throws NodeError.
  void make(const experiment::Change& change);

 private:
  const experiment::Experiment& experiment_;
  Graph& graph_;
  std::string folder_;
  WriteFailures& failures_;
  std::size_t repeated_ = 0;
};

}  // namespace spikeloop::fused
