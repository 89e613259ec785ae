#include "spikeloop/robot/stepped_robot.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/random.hpp"

namespace spikeloop::robot {
namespace {

constexpr TimeNs kRowPeriod = 20'000'000;  // of the trajectory, and of a step of a task

TimeNs next_row(TimeNs time) {
  return (time / kRowPeriod + 1) * kRowPeriod;
}

/// +1 for the right goal, -1 for another. Without a name of the right one, goal i belongs to place
/// i of the cue. On a lane 1 in the middle, down to 0 at its edges, where the episode ends.
StepResult result_of(const vehicle::Vehicle& vehicle, const EpisodeSettings& settings) {
  if (settings.collision_reward && vehicle.collisions_since_reset() > 0) {
    return {*settings.collision_reward, true, false};
  }
  const vehicle::Pose pose = vehicle.pose();
  const auto& goals = vehicle.goals();
  const auto goal = std::ranges::find_if(goals, [&](const vehicle::Obstacle& candidate) {
    return candidate.distance_m(pose.x_m, pose.y_m) == 0;
  });
  if (goal == goals.end()) {
    const auto lane = vehicle.lane_position();
    if (!lane) return {};
    const double part = std::abs(lane->distance_m) / lane->half_width_m;
    return {std::max(0.0, 1 - part), !lane->is_inside(), false};
  }
  const bool right = settings.goal.empty() ? vehicle.cue_place() == 0 ||
                                                 goal - goals.begin() == vehicle.cue_place() - 1
                                           : goal->name == settings.goal;
  return {right ? 1.0 : -1.0, true, right};
}

/// Only a start that the file gives can be there.
void refuse_start_off_the_lane(const vehicle::Vehicle& vehicle, const std::string& world) {
  const auto lane = vehicle.lane_position();
  if (lane && !lane->is_inside()) {
    throw ConfigurationError(
        Location{world},
        with_code(Code::world,
                  "numeric 'start' = ({}, {}) is not on a lane, so that every episode would end at "
                  "its first step; write a place on a box lane_*, or leave it out",
                  vehicle.pose().x_m, vehicle.pose().y_m));
  }
}

void check_goal(const std::string& name, const vehicle::Vehicle& vehicle) {
  std::vector<std::string> known;
  for (const vehicle::Obstacle& goal : vehicle.goals()) {
    known.push_back(goal.name);
  }
  if (!name.empty() && std::ranges::find(known, name) == known.end()) {
    throw ConfigurationError(
        with_code(Code::unknown_choice, "key 'episodes': the world has no goal '{}'; {}", name,
                  known.empty() ? "leave  goal  out"
                                : fmt::format("write one of: {}", fmt::join(known, ", "))));
  }
}

/// Films see by the camera that is a sensor.
SpectatorOptions spectators_of(const RobotOptions& options) {
  SpectatorOptions spectators = options.spectators;
  if (spectators.film && options.sensors.camera) {
    spectators.film->camera = options.sensors.camera->name;
  }
  return spectators;
}

std::unique_ptr<vehicle::Simulation> simulation_of(const RobotOptions& options) {
  if (options.model) return std::make_unique<vehicle::Simulation>(*options.model);
  return std::make_unique<vehicle::Vehicle>(options.vehicle);
}

}  // namespace

SteppedRobot::SteppedRobot(const RobotOptions& options)
    : robot_(simulation_of(options)),
      seed_(options.vehicle.seed),
      sensors_(*robot_, options.sensors),
      spectators_(*robot_, spectators_of(options)),
      command_topic_(*robot_, options.sensors.dialect) {
  if (!options.folder.empty() && robot_->vehicle() != nullptr) {
    write_world(options.folder, *robot_->vehicle(), options.vehicle.seed);
    trajectory_.emplace(options.folder, options.failures);
  }
  if (options.episodes) {
    refuse_start_off_the_lane(vehicle(), options.vehicle.world);
    EpisodeSettings settings = *options.episodes;
    settings.step = kRowPeriod;
    check_goal(settings.goal, vehicle());
    settings.lasts = vehicle().goals().empty() && !vehicle().lanes().empty();
    episodes_.emplace(settings, options.folder, options.failures);
    episodes_->begin(0);
    sensors_.add_numbers("reward", kRowPeriod,
                         [this] { return std::vector{episodes_->told_reward()}; });
    sensors_.add_numbers("episode", kRowPeriod, [this] { return episodes_->state(); });
  }
}

CommandDescription SteppedRobot::command_description() const {
  return {command_topic_.name(), command_topic_.type(), command_topic_.fields()};
}

nlohmann::json SteppedRobot::summary() const {
  nlohmann::json summary = summary_of(*robot_);
  if (episodes_) summary.update(episodes_->summary());
  return summary;
}

void SteppedRobot::command(std::span<const std::byte> message) {
  std::vector<double> numbers = command_topic_.read(message);
  if (command_ && robot_->vehicle() == nullptr) {
    // Several messages may name an actuator each.
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (!std::isfinite(numbers[i])) numbers[i] = (*command_)[i];
    }
  }
  command_ = std::move(numbers);
}

void SteppedRobot::step_episode() {
  const TimeNs now = robot_->time();
  if (episodes_->running()) {
    episodes_->step(now, result_of(vehicle(), episodes_->settings()));
    if (!episodes_->running()) act(std::array{0.0, 0.0});
  } else if (episodes_->wait(now)) {
    episodes_->begin(now);
    vehicle().reset(episode_seed(seed_, episodes_->number()));
    sensors_.begin_anew();
    if (newest_) act(*newest_);  // which nobody may send again
  }
}

void SteppedRobot::write_row() {
  const vehicle::Vehicle& vehicle = *robot_->vehicle();
  trajectory_->write(vehicle.odometry(), vehicle.statistics().collisions);
}

void SteppedRobot::publish(TimeNs time, const Wanted& wanted, const Publish& publish) {
  for (std::size_t topic = 0; topic < topics().size(); ++topic) {
    if (sensors_.due(topic, time) && wanted(topic)) {
      publish(topic, sensors_.write(topic, *robot_));
    }
  }
}

/// Stops at every row of the trajectory, and at every picture.
void SteppedRobot::advance(TimeNs time) {
  for (TimeNs now = robot_->time(); now < time;) {
    if (trajectory_ && now % kRowPeriod == 0) write_row();
    const TimeNs next = std::min({time, next_row(now), std::max(now + 1, spectators_.next())});
    robot_->step(next - now);
    spectators_.look(*robot_);
    now = next;
    if (episodes_ && now % kRowPeriod == 0) step_episode();
  }
  if (command_) {
    if (!episodes_ || episodes_->running()) act(*command_);
    newest_ = std::move(command_);
    command_.reset();
  }
}

void SteppedRobot::finish() {
  if (episodes_) episodes_->finish();
  if (trajectory_) {
    write_row();
    trajectory_->close();
    trajectory_.reset();
  }
  spectators_.finish(*robot_);
}

}  // namespace spikeloop::robot
