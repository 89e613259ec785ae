// The plain data of one step of an endpoint, without a graph.
#pragma once

#include <vector>

#include "spikeloop/core/signal.hpp"

namespace spikeloop::test {

/// Outputs of a source: receive(), then look at `values` and `revision`.
class OutputData {
 public:
  explicit OutputData(const std::vector<std::uint32_t>& widths) {
    for (const std::uint32_t width : widths) {
      values_.emplace_back(width);
    }
    for (auto& values : values_) {
      outputs_.push_back({values.data(), 0, static_cast<std::uint32_t>(values.size()), 0});
    }
    data_.end_ns = 1'000'000;
    data_.signal_outputs = outputs_.data();
    data_.signal_output_count = static_cast<std::uint32_t>(outputs_.size());
  }

  Step step() const { return Step(data_); }
  const std::vector<double>& values(std::size_t port) const { return values_[port]; }
  std::uint64_t revision(std::size_t port) const { return outputs_[port].revision; }

 private:
  std::vector<std::vector<double>> values_;
  std::vector<spikeloop_signal_output> outputs_;
  spikeloop_step data_{};
};

}  // namespace spikeloop::test
