// The robot of an experiment, in the robot's own words.
#pragma once

#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/robot/sensors.hpp"

namespace spikeloop::fused {

inline robot::SensorOptions sensor_options(const experiment::Robot& robot) {
  robot::SensorOptions options;
  if (robot.camera) {
    options.camera = pictures::CameraOptions{{robot.camera->width, robot.camera->height},
                                             robot.camera->rate_hz,
                                             robot.camera->field_of_view_deg};
  }
  return options;
}

}  // namespace spikeloop::fused
