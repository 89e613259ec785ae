#include "laser.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::vehicle {
namespace {

constexpr std::string_view kMeaning =
    "beams (2 to 10000), first and last angle (rad, rising), smallest and largest range (m, "
    "rising), scans per second (0.001 to 1000)";

void hide_vehicle(mjModel& model, const Parts& parts) {
  for (int geom = 0; geom < model.ngeom; ++geom) {
    if (parts.own_geom[static_cast<std::size_t>(geom)]) {
      model.geom_group[geom] = kVehicleGroup;
    } else if (model.geom_group[geom] == kVehicleGroup) {
      model.geom_group[geom] = 0;
    }
  }
}

}  // namespace

Laser::Laser(mjModel& model, const Names& names, const Parts& parts) : site_(parts.site) {
  const auto values = names.required_numeric("laser", 6, kMeaning);
  const double beams = values[0];
  if (!(beams >= 2 && beams <= 10000 && beams == std::floor(beams) && values[1] < values[2] &&
        values[3] >= 0 && values[3] < values[4] && values[5] >= 0.001 && values[5] <= 1000)) {
    throw ConfigurationError(
        names.where("laser"),
        with_code(Code::world, "numeric 'laser' is \"{}\"; write 6 numbers: {}",
                  fmt::join(values, " "), kMeaning));
  }
  beams_ = static_cast<std::size_t>(beams);
  angle_min_ = values[1];
  angle_step_ = (values[2] - values[1]) / (beams - 1);
  range_min_ = values[3];
  range_max_ = values[4];
  empty_.angle_min_rad = static_cast<float>(angle_min_);
  empty_.angle_max_rad = static_cast<float>(values[2]);
  empty_.angle_increment_rad = static_cast<float>(angle_step_);
  empty_.scan_time_s = static_cast<float>(1 / values[5]);
  empty_.range_min_m = static_cast<float>(range_min_);
  empty_.range_max_m = static_cast<float>(range_max_);
  hide_vehicle(model, parts);
}

LaserScan Laser::scan(const mjModel& model, const mjData& data, TimeNs stamp) const {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const mjtNum* origin = data.site_xpos + 3 * site_;
  const mjtNum* axes = data.site_xmat + 9 * site_;  // columns: ahead, left, up
  LaserScan scan = empty_;
  scan.stamp = stamp;
  scan.ranges_m.reserve(beams_);
  for (std::size_t i = 0; i < beams_; ++i) {
    const double angle = angle_min_ + static_cast<double>(i) * angle_step_;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const mjtNum direction[3] = {c * axes[0] + s * axes[1], c * axes[3] + s * axes[4],
                                 c * axes[6] + s * axes[7]};
    int hit = -1;
    const double range = mj_ray(&model, &data, origin, direction, kAllButVehicle, 1, -1, &hit);
    if (hit < 0 || range > range_max_) {
      scan.ranges_m.push_back(kInfinity);
    } else {
      scan.ranges_m.push_back(range < range_min_ ? -kInfinity : static_cast<float>(range));
    }
  }
  return scan;
}

}  // namespace spikeloop::vehicle
