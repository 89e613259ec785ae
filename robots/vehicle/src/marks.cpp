#include "marks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::vehicle {

std::vector<Obstacle> find_marks(const mjModel& model, const mjData& data, const Names& names,
                                 std::string_view prefix) {
  std::vector<Obstacle> marks;
  for (int geom = 0; geom < model.ngeom; ++geom) {
    const std::string name = names.geom(geom);
    if (name.starts_with(prefix)) {
      if (model.geom_type[geom] != mjGEOM_BOX) {
        throw ConfigurationError(
            Location{names.path()},
            with_code(Code::world,
                      "geom '{}' is not a box, as marks {}* of the floor are; write type=\"box\", "
                      "or give it another name",
                      name, prefix));
      }
      const mjtNum* at = data.geom_xpos + 3 * geom;
      const mjtNum* axes = data.geom_xmat + 9 * geom;
      marks.push_back({.name = name,
                       .x_m = at[0],
                       .y_m = at[1],
                       .theta_rad = std::atan2(axes[3], axes[0]),
                       .half_x_m = model.geom_size[3 * geom],
                       .half_y_m = model.geom_size[3 * geom + 1]});
    }
  }
  return marks;
}

CentreLine::CentreLine(const Obstacle& box)
    : middle{box.x_m, box.y_m,
             box.half_x_m >= box.half_y_m ? box.theta_rad : box.theta_rad + std::numbers::pi / 2},
      half_length_m(std::max(box.half_x_m, box.half_y_m)),
      half_width_m(std::min(box.half_x_m, box.half_y_m)) {}

Pose CentreLine::at(double along_m) const {
  return {middle.x_m + along_m * std::cos(middle.theta_rad),
          middle.y_m + along_m * std::sin(middle.theta_rad), middle.theta_rad};
}

std::optional<LanePosition> find_lane_position(const std::vector<Obstacle>& lanes,
                                               const Pose& pose) {
  std::optional<LanePosition> result;
  double least = 0;
  for (const Obstacle& lane : lanes) {
    const CentreLine line(lane);
    const double along = std::cos(line.middle.theta_rad) * (pose.x_m - line.middle.x_m) +
                         std::sin(line.middle.theta_rad) * (pose.y_m - line.middle.y_m);
    const Pose nearest = line.at(std::clamp(along, -line.half_length_m, line.half_length_m));
    const double dx = pose.x_m - nearest.x_m;
    const double dy = pose.y_m - nearest.y_m;
    const double distance = std::hypot(dx, dy);
    // In widths of the lane, so that a vehicle inside a wide lane is not judged by a narrow one.
    if (result && distance / line.half_width_m >= least) continue;
    least = distance / line.half_width_m;
    // A box has no direction: of the line's two, the one that is nearer to the heading.
    const double angle = std::remainder(pose.theta_rad - nearest.theta_rad, std::numbers::pi);
    const double ahead = pose.theta_rad - angle;
    const double to_the_left = std::cos(ahead) * dy - std::sin(ahead) * dx;
    result = {std::copysign(distance, to_the_left), angle, line.half_width_m};
  }
  return result;
}

}  // namespace spikeloop::vehicle
