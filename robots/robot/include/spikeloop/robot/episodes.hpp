// Episodes of a task: where each begins and ends, what reward is told, and a row of episodes.csv
// for each that has ended. The last observation and reward of an episode are there for `hold`; then
// comes the pause.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/robot/files.hpp"

namespace spikeloop::robot {

inline constexpr const char* kEpisodesFile = "episodes.csv";

struct EpisodeSettings {
  TimeNs step = 0;                       ///< simulated time of a step
  std::optional<std::uint64_t> count{};  ///< after which the run is over; none: never
  TimeNs time_limit = kNever;            ///< an episode ends at the first step not before it
  TimeNs hold = 0;                       ///< at least a step
  TimeNs pause = 0;
  std::optional<double> begin_reward{};    ///< told in the pause and until the first step; none: 0
  std::optional<double> end_reward{};      ///< told in the place of the last step's
  std::optional<double> failure_reward{};  ///< the same, where the last step's is 0
  std::string goal{};  ///< of the vehicle: the right one; empty: as its cue says
  std::optional<double> collision_reward{};  ///< of a step of the vehicle that touches a thing, and
                                             ///< ends the episode; none: it goes on
  bool lasts = false;                        ///< success is to last until the time limit
};

/// What a step of a task gave.
struct StepResult {
  double reward = 0;
  bool terminated = false;  ///< the episode is over
  bool success = false;
  bool truncated = false;  ///< the same, by a time limit of the task's own
};

class Episodes {
 public:
  /// @param folder where episodes.csv is written; empty: nowhere
  /// @param failures see RowFile
  /// @throws FileError when it cannot be written.
  Episodes(const EpisodeSettings& settings, const std::string& folder,
           WriteFailures* failures = nullptr);

  /// The next episode begins now.
  void begin(TimeNs time);
  /// The episode has not had its first step: its time begins now.
  void postpone(TimeNs time) { began_ = time; }
  /// A step of the episode has ended now; perhaps the episode, too. @throws FileError
  void step(TimeNs time, const StepResult& result);

  /// Between two episodes, at the end of a step. True: the next one is to begin.
  bool wait(TimeNs time);

  bool running() const { return phase_ == Phase::running; }
  bool in_pause() const { return phase_ == Phase::pause; }
  /// The pause after the last episode has begun.
  bool over() const { return in_pause() && settings_.count && ended_.size() >= *settings_.count; }

  const EpisodeSettings& settings() const { return settings_; }
  TimeNs step_time() const { return settings_.step; }
  std::uint64_t number() const { return number_; }  ///< of the newest episode, from 1
  std::uint64_t steps() const { return steps_; }    ///< of the newest episode
  double total() const { return return_; }          ///< its return
  /// The newest episode has ended, before its time limit.
  bool terminated() const { return !running() && !ended_.empty() && ended_.back().terminated; }
  /// The newest episode has ended with success.
  bool success() const { return !running() && !ended_.empty() && ended_.back().success; }
  /// What the topic `reward` tells.
  double told_reward() const { return told_reward_; }
  /// What the topic `episode` tells: number, 1 while it runs and 0 after its end, steps, return.
  std::vector<double> state() const;
  /// Of the episodes that have ended: episodes, successes, median_return, mean_return.
  nlohmann::json summary() const;
  /// @throws FileError
  void finish();

 private:
  struct Ended {
    double total;
    bool success;
    bool terminated;
  };
  void end(TimeNs time, const StepResult& result);

  EpisodeSettings settings_;
  std::optional<RowFile> file_;
  std::uint64_t number_ = 0;
  enum class Phase { running, ended, pause } phase_ = Phase::pause;
  TimeNs began_ = 0;
  TimeNs ended_at_ = 0;
  std::uint64_t steps_ = 0;
  double return_ = 0;
  double told_reward_ = 0;
  std::vector<Ended> ended_;
};

}  // namespace spikeloop::robot
