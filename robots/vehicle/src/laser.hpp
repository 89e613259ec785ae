// The laser: one ray a beam from the site `laser`; MuJoCo 2.2.2 has no call for many rays at once.
#pragma once

#include "model.hpp"

namespace spikeloop::vehicle {

class Laser {
 public:
  /// Reads numeric `laser`; gives the vehicle's geoms a group of their own that rays do not see.
  Laser(mjModel& model, const Names& names, const Parts& parts);
  /// `data` must hold the positions that belong to its state (mj_kinematics).
  LaserScan scan(const mjModel& model, const mjData& data, TimeNs stamp) const;

 private:
  LaserScan empty_;  // everything but stamp and ranges
  std::size_t beams_ = 0;
  double angle_min_ = 0;
  double angle_step_ = 0;
  double range_min_ = 0;
  double range_max_ = 0;
  int site_ = 0;
};

}  // namespace spikeloop::vehicle
