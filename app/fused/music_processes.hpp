// The other processes of a MUSIC job, and this one as one of them.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/fused/other_processes.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/process/process.hpp"

namespace spikeloop {

class MusicProcesses : public fused::OtherProcesses {
 public:
  MusicProcesses(music::Process& process, const experiment::Experiment& experiment)
      : process_(process), experiment_(experiment) {}

  std::uint32_t delay(const experiment::Connection& edge) const override {
    return experiment::music_delay(experiment_, edge);
  }
  std::unique_ptr<Source> source(const experiment::Connection& edge) override;
  std::unique_ptr<Sink> sink(const experiment::Connection& edge) override;
  void meet() override;
  void exchange() override { loop_->exchange(); }

  /// How far the loop around us is, for the launcher.
  void take(const fused::Progress& progress) { progress_ = progress; }
  /// The last report, and MUSIC's end. Before meet() there is nothing to end.
  void finish(const nlohmann::json& summary);

 private:
  music::Process& process_;
  const experiment::Experiment& experiment_;
  // MUSIC's finalize still gives spikes to their handlers, when the graph has gone.
  std::vector<std::shared_ptr<Source>> sources_;
  std::vector<std::shared_ptr<Sink>> sinks_;
  fused::Progress progress_;
  nlohmann::json summary_ = nlohmann::json::object();
  std::unique_ptr<music::Process::Loop> loop_;
};

}  // namespace spikeloop
