// All processes of a run, as the view sees them.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/live/feed.hpp"

namespace spikeloop::view {

class Hub {
 public:
  /// @param folder of the feeds, which come as the processes begin
  /// @param recording of a run that has ended: there is no robot to stop
  Hub(std::string folder, bool recording);

  /// The first channel, which no process has: what the view lost, {"lost": bytes of processes,
  /// "dropped": messages for this viewer}.
  static constexpr std::uint32_t kLosses = 0;

  using Take =
      std::function<void(std::uint32_t channel, TimeNs time, std::span<const std::byte> message)>;

  /// Looks for processes and channels that are new. Returns the number of channels; those that were
  /// known keep their numbers.
  std::size_t look();
  const live::Channel& channel(std::size_t number) const { return channels_[number]; }
  /// Reads what is new.
  void read(const Take& take);
  /// Simulated time of the newest message.
  TimeNs time() const { return time_; }
  /// Bytes that were overwritten before they were read.
  std::uint64_t lost() const;
  /// How often viewers have to forget what they know: another time of a recording was asked for.
  std::uint32_t beginnings();

  /// A viewer has subscribed to a channel.
  void watch();

  /// As the Foxglove protocol has them: [{"name": "run.stop", "value": false}, ...].
  nlohmann::json parameters() const;
  /// Sets a parameter; STOP is set by the thread that receives the message, and only checked here.
  /// @return the error. Empty if the value is valid
  std::string set(const std::string& name, const nlohmann::json& value);

 private:
  struct Process {
    live::FeedReader feed;
    std::vector<std::uint32_t> numbers;  ///< of its channels among all
  };

  std::string change(const std::string& name, double value);
  bool has(bool live::About::*property) const;

  std::string folder_;
  bool recording_;
  live::StopFlag stop_;
  std::set<std::string> known_;
  std::vector<Process> processes_;
  std::vector<live::Channel> channels_;
  TimeNs time_ = 0;
  std::uint32_t beginnings_ = 0;
};

}  // namespace spikeloop::view
