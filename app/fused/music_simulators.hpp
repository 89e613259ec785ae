// Simulators as programs of a MUSIC job, and this process as one of them.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "spikeloop/fused/run.hpp"
#include "spikeloop/fused/simulators.hpp"
#include "spikeloop/process/process.hpp"

namespace spikeloop {

class MusicSimulators : public fused::Simulators {
 public:
  explicit MusicSimulators(music::Process& process) : process_(process) {}

  std::unique_ptr<Source> output(const experiment::Link& link) override;
  std::unique_ptr<Sink> input(const experiment::Link& link) override;
  void meet() override;
  void exchange() override { loop_->exchange(); }

  /// How far the loop around us is, for the launcher.
  void take(const fused::Progress& progress) { progress_ = progress; }
  /// The last report, and MUSIC's end. Before meet() there is nothing to end.
  void finish(const nlohmann::json& summary);

 private:
  music::Process& process_;
  // MUSIC's finalize still gives spikes to their handlers, when the graph has gone.
  std::vector<std::shared_ptr<Source>> sources_;
  std::vector<std::shared_ptr<Sink>> sinks_;
  fused::Progress progress_;
  nlohmann::json summary_ = nlohmann::json::object();
  std::unique_ptr<music::Process::Loop> loop_;
};

}  // namespace spikeloop
