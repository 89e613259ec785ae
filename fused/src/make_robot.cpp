#include "make_robot.hpp"

namespace spikeloop::fused {
namespace {

using experiment::Experiment;

robot::EpisodeSettings episode_settings(const experiment::Episodes& episodes) {
  return {.count = episodes.count,
          .time_limit = episodes.time_limit.value_or(kNever),
          .hold = episodes.hold,
          .pause = episodes.pause,
          .begin_reward = episodes.begin_reward,
          .end_reward = episodes.end_reward,
          .failure_reward = episodes.failure_reward,
          .goal = episodes.goal,
          .collision_reward = episodes.collision_reward};
}

std::unique_ptr<robot::Robot> make_environment(const Experiment& experiment, const RobotUse& use) {
  const experiment::Environment& environment = *experiment.robot->environment;
  robot::EnvironmentOptions options;
  options.name = environment.name;
  options.environment.slippery = environment.slippery;
  options.step = environment.step;
  options.seed = experiment.robot->seed;
  options.dialect = use.dialect;
  options.folder = use.folder;
  options.failures = use.failures;
  if (experiment.episodes) {
    options.episodes = episode_settings(*experiment.episodes);
    options.pause_observation = experiment.episodes->pause_observation;
  }
  return std::make_unique<robot::EnvironmentRobot>(options);
}

}  // namespace

std::unique_ptr<robot::Robot> make_robot(const Experiment& experiment, const RobotUse& use) {
  const experiment::Robot& robot = *experiment.robot;
  if (robot.environment) {
    return make_environment(experiment, use);
  }
  robot::RobotOptions options;
  options.vehicle = {robot.world, robot.seed};
  options.spectators = use.spectators;
  options.folder = use.folder;
  options.failures = use.failures;
  options.sensors.blind = use.blind;
  options.sensors.dialect = use.dialect;
  if (robot.model) {
    options.model = {robot.model->file, robot.model->keyframe};
    options.sensors.rate_hz = robot.model->rate_hz;
  }
  if (const auto& camera = robot.camera) {
    options.sensors.camera = pictures::CameraOptions{
        {camera->width, camera->height}, camera->rate_hz, camera->field_of_view_deg, camera->name};
  }
  if (experiment.episodes && !robot.model) {  // check refuses it
    options.episodes = episode_settings(*experiment.episodes);
  }
  return std::make_unique<robot::SteppedRobot>(options);
}

}  // namespace spikeloop::fused
