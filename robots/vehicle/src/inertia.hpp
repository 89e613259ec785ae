// The inertial unit: mean acceleration from the velocities of the last physics steps.
#pragma once

#include <deque>

#include "model.hpp"
#include "spikeloop/vehicle/sensors.hpp"

namespace spikeloop::vehicle {

class Inertia {
 public:
  explicit Inertia(TimeNs timestep);
  /// After every physics step, and once at the start.
  void look(const mjData& data, const Parts& parts);
  Imu read(const mjModel& model, const mjData& data, const Parts& parts, TimeNs stamp) const;

 private:
  std::size_t steps_;
  double timestep_s_;
  std::deque<Vector3> velocities_;  // in the arena's frame; one more than there are steps
};

}  // namespace spikeloop::vehicle
