// Plays a run folder to the live view, as the run's processes did.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "run_recordings.hpp"
#include "spikeloop/live/feed.hpp"

namespace spikeloop::app {

class RunPlayer {
 public:
  /// Tells the view what there is.
  /// @param recordings must outlive it; @param feeds as live::Feed
  RunPlayer(const RunRecordings& recordings, const std::string& feeds);

  /// To be called some fifty times a second, with the wall time. The recording stands at its begin
  /// until a viewer has subscribed.
  void advance(TimeNs now);

 private:
  struct Spikes {
    const RecordedSpikes* of;
    std::uint32_t channel = 0;
    std::size_t next = 0;
  };
  struct Signal {
    const RecordedSignal* of;
    std::uint32_t channel = 0;
    std::size_t next = 0;
  };
  struct Topic {
    bag::Connection connection;
    bag::Stream stream;
    std::uint32_t channel = 0;
    std::optional<bag::Message> waiting{};
  };

  void add_messages();
  void publish(std::uint32_t channel, TimeNs time, const std::vector<std::byte>& message);
  void catch_up();
  void go_on(TimeNs passed);
  void play(TimeNs until);
  void go_to(TimeNs time);
  void tell();
  nlohmann::json spike_counts() const;

  const RunRecordings& run_;
  live::Feed feed_;
  std::vector<Spikes> spikes_;
  std::vector<Signal> signals_;
  std::vector<Topic> topics_;
  std::uint32_t status_ = 0;
  TimeNs time_ = 0;         ///< simulated; what is up to here was played
  TimeNs wanted_ = 0;       ///< simulated; up to here as fast as it can be shown
  TimeNs asked_ = 0;        ///< wall time of the last advance()
  TimeNs next_status_ = 0;  ///< wall time
  std::uint64_t steps_ = 0;
  std::size_t published_ = 0;  ///< bytes
  std::vector<std::byte> message_;
};

}  // namespace spikeloop::app
