// Plays a run folder to the live view, as the run's processes did.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/bag/reader.hpp"
#include "spikeloop/live/feed.hpp"
#include "spikeloop/record/reader.hpp"

namespace spikeloop::app {

class RunPlayer {
 public:
  /// Reads the recordings. @throws FileError, ConfigurationError: no run with recordings.
  explicit RunPlayer(const std::string& folder);

  /// Of the experiment.
  const std::string& name() const { return name_; }
  /// Tells the view what there is. @param feeds as live::Feed
  void open(const std::string& feeds);
  /// To be called some fifty times a second, with the wall time.
  void advance(TimeNs now);

 private:
  struct Spikes {
    std::string end;
    record::SpikeRecording recording;
    std::uint32_t channel = 0;
    std::size_t next = 0;
  };
  struct Signal {
    std::string end;
    record::SignalRecording recording;
    std::uint32_t channel = 0;
    std::size_t next = 0;
  };
  struct Topic {
    bag::Connection connection;
    bag::Stream stream;
    std::uint32_t channel = 0;
    std::optional<bag::Message> waiting{};
  };

  void read_recordings(const std::string& node);
  void read_messages();
  void play(TimeNs until);
  void go_to(TimeNs time);
  void tell();
  nlohmann::json spike_counts() const;

  std::string folder_;
  std::string name_;
  TimeNs tick_ = 0;
  TimeNs end_ = 0;
  std::vector<Spikes> spikes_;
  std::vector<Signal> signals_;
  std::unique_ptr<bag::Reader> messages_;
  std::vector<Topic> topics_;
  std::unique_ptr<live::Feed> feed_;
  std::uint32_t status_ = 0;
  TimeNs time_ = 0;         ///< simulated; what is up to here was played
  TimeNs asked_ = 0;        ///< wall time of the last advance()
  TimeNs next_status_ = 0;  ///< wall time
  std::uint64_t steps_ = 0;
  std::vector<std::byte> message_;
};

}  // namespace spikeloop::app
