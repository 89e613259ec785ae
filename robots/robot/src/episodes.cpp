#include "spikeloop/robot/episodes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>

namespace spikeloop::robot {

Episodes::Episodes(const EpisodeSettings& settings, const std::string& folder,
                   WriteFailures* failures)
    : settings_(settings) {
  settings_.hold = std::max(settings_.hold, settings_.step);
  if (!folder.empty()) {
    file_.emplace((std::filesystem::path(folder) / kEpisodesFile).string(),
                  "episode,begin_s,end_s,steps,return,success,end", failures);
  }
}

void Episodes::begin(TimeNs time) {
  ++number_;
  phase_ = Phase::running;
  began_ = time;
  steps_ = 0;
  return_ = 0;
  told_reward_ = settings_.begin_reward.value_or(0);
}

void Episodes::step(TimeNs time, const StepResult& result) {
  ++steps_;
  return_ += result.reward;
  told_reward_ = result.reward;
  if (result.terminated || result.truncated || time - began_ >= settings_.time_limit) {
    end(time, result);
  }
}

void Episodes::end(TimeNs time, const StepResult& result) {
  phase_ = Phase::ended;
  ended_at_ = time;
  if (settings_.end_reward) {
    told_reward_ = *settings_.end_reward;
  } else if (result.reward == 0 && settings_.failure_reward) {
    told_reward_ = *settings_.failure_reward;
  }
  const bool success = result.success || (settings_.lasts && !result.terminated);
  ended_.push_back({return_, success, result.terminated});
  if (file_) {
    file_->write(fmt::format("{},{:.9g},{:.9g},{},{},{},{}\n", number_, to_seconds(began_),
                             to_seconds(time), steps_, return_, success ? 1 : 0,
                             result.terminated ? "terminated" : "time_limit"));
    file_->flush();  // the file can be read while the run continues
  }
}

bool Episodes::wait(TimeNs time) {
  if (time - ended_at_ >= settings_.hold) {
    phase_ = Phase::pause;
    told_reward_ = settings_.begin_reward.value_or(0);
  }
  return in_pause() && !over() && time - ended_at_ - settings_.hold >= settings_.pause;
}

std::vector<double> Episodes::state() const {
  return {static_cast<double>(number_), running() ? 1.0 : 0.0, static_cast<double>(steps_),
          return_};
}

nlohmann::json Episodes::summary() const {
  nlohmann::json summary{{"episodes", ended_.size()},
                         {"successes", std::ranges::count(ended_, true, &Ended::success)}};
  if (!ended_.empty()) {
    std::vector<double> returns;
    for (const Ended& episode : ended_) {
      returns.push_back(episode.total);
    }
    summary["mean_return"] =
        std::accumulate(returns.begin(), returns.end(), 0.0) / static_cast<double>(returns.size());
    std::ranges::sort(returns);
    const std::size_t half = returns.size() / 2;
    summary["median_return"] =
        returns.size() % 2 == 1 ? returns[half] : (returns[half - 1] + returns[half]) / 2;
  }
  return summary;
}

void Episodes::finish() {
  if (file_) {
    file_->close();
  }
}

}  // namespace spikeloop::robot
