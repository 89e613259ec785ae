// Marks of the floor: boxes whose names say what they are for. Goals and lanes are marks.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "model.hpp"

namespace spikeloop::vehicle {

inline constexpr std::string_view kGoalPrefix = "goal_";
inline constexpr std::string_view kLanePrefix = "lane_";

/// The boxes whose names begin with `prefix`, seen from above, where mj_kinematics() has put them.
/// @throws ConfigurationError for a geom of such a name that is not a box.
std::vector<Obstacle> find_marks(const mjModel& model, const mjData& data, const Names& names,
                                 std::string_view prefix);

/// The centre line of a lane's box, along its longer sides.
struct CentreLine {
  explicit CentreLine(const Obstacle& box);
  /// The point at `along_m` from the middle of the line, in its direction.
  Pose at(double along_m) const;

  Pose middle;
  double half_length_m = 0;
  double half_width_m = 0;  ///< of the lane
};

/// Of a pose; nothing when there are no lanes.
std::optional<LanePosition> find_lane_position(const std::vector<Obstacle>& lanes,
                                               const Pose& pose);

}  // namespace spikeloop::vehicle
