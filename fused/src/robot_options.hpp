// The robot of an experiment, in the robot's own words.
#pragma once

#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/robot/stepped_robot.hpp"

namespace spikeloop::fused {

inline robot::RobotOptions robot_options(const experiment::Robot& robot) {
  robot::RobotOptions options;
  options.vehicle = {robot.world, robot.seed};
  if (robot.model) {
    options.model = {robot.model->file, robot.model->keyframe};
    options.sensors.rate_hz = robot.model->rate_hz;
  }
  if (const auto& camera = robot.camera) {
    options.sensors.camera = pictures::CameraOptions{
        {camera->width, camera->height}, camera->rate_hz, camera->field_of_view_deg, camera->name};
  }
  return options;
}

}  // namespace spikeloop::fused
