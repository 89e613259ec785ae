#include "spikeloop/robot/environment_robot.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace spikeloop::robot {
namespace {

enum Topic : std::size_t { kObservation, kReward, kEpisode };

EpisodeSettings with_defaults(EpisodeSettings settings, const environments::Description& about,
                              TimeNs step) {
  if (settings.time_limit == kNever && about.max_steps > 0) {
    const auto longest = static_cast<std::uint64_t>(kNever / step);
    settings.time_limit =
        about.max_steps < longest ? static_cast<TimeNs>(about.max_steps) * step : kNever;
  }
  settings.step = step;
  settings.lasts = about.lasts;
  return settings;
}

}  // namespace

EnvironmentRobot::EnvironmentRobot(const EnvironmentOptions& options)
    : environment_(environments::make(options.name, options.environment)),
      seed_(options.seed),
      step_(options.step.value_or(environment_->description().step)),
      pause_observation_(options.pause_observation),
      episodes_(with_defaults(options.episodes, environment_->description(), step_), options.folder,
                options.failures),
      message_(options.dialect),
      action_reader_(messages::Catalog::builtin(options.dialect), kNumbersType, "data[0]") {
  const bool bounded = std::ranges::all_of(
      environment_->description().observation, [](const environments::Quantity& quantity) {
        return std::isfinite(quantity.high - quantity.low) && quantity.high > quantity.low;
      });
  for (const char* const name : {"observation", "reward", "episode", "scaled_observation"}) {
    topics_.push_back({name, kNumbersType, step_});
  }
  if (!bounded) {
    topics_.pop_back();  // there is nothing to scale by
  }
  begin(0);
}

CommandDescription EnvironmentRobot::command_description() const {
  return {"action", kNumbersType, {action_reader_.path().text}};
}

void EnvironmentRobot::begin(TimeNs time) {
  episodes_.begin(time);
  environment_->reset(seed_, episodes_.number());
}

void EnvironmentRobot::publish(TimeNs time, const Wanted& wanted, const Publish& publish) {
  if (published_ >= 0 && time / step_ == published_ / step_) {
    return;
  }
  published_ = time;
  for (std::size_t topic = 0; topic < topics_.size(); ++topic) {
    if (wanted(topic)) {
      publish(topic, write(topic));
    }
  }
}

void EnvironmentRobot::command(std::span<const std::byte> message) {
  std::vector<double> numbers;
  if (action_reader_.read(message, numbers) > 0 && std::isfinite(numbers.front())) {
    newest_ = numbers.front();
  }
}

/// Without an action it waits, and so does its time.
void EnvironmentRobot::advance(TimeNs time) {
  for (TimeNs end = (now_ / step_ + 1) * step_; end <= time; end += step_) {
    if (!episodes_.running()) {
      if (episodes_.wait(end)) begin(end);
    } else if (!action_) {
      episodes_.postpone(end);
    } else {
      const environments::Outcome outcome = environment_->step(*action_);
      episodes_.step(end, {outcome.reward, outcome.terminated, outcome.success, outcome.truncated});
    }
  }
  now_ = time;
  action_ = newest_;
}

nlohmann::json EnvironmentRobot::summary() const {
  return episodes_.summary();
}

std::vector<double> EnvironmentRobot::observation() const {
  const auto values = environment_->observation();
  if (episodes_.in_pause() && pause_observation_) {
    return std::vector<double>(values.size(), *pause_observation_);
  }
  return {values.begin(), values.end()};
}

std::vector<double> EnvironmentRobot::scaled(std::vector<double> observation) const {
  const auto& quantities = environment_->description().observation;
  for (std::size_t i = 0; i < observation.size(); ++i) {
    const auto& [name, low, high] = quantities[i];
    observation[i] = 2 * (observation[i] - low) / (high - low) - 1;
  }
  return observation;
}

std::span<const std::byte> EnvironmentRobot::write(std::size_t topic) {
  switch (topic) {
    case kObservation:
      return message_.write(observation());
    case kReward:
      return message_.write(std::vector{episodes_.told_reward()});
    case kEpisode:
      return message_.write(episodes_.state());
    default:
      return message_.write(scaled(observation()));
  }
}

}  // namespace spikeloop::robot
