#include "spikeloop/vehicle/vehicle.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "inertia.hpp"
#include "journey.hpp"
#include "laser.hpp"
#include "layout.hpp"
#include "marks.hpp"
#include "model.hpp"
#include "photodiodes.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::vehicle {
namespace {

constexpr double kLongestTimestep = 0.01;  // s; wheels would bounce

struct Limits {
  double linear_m_s = 0;
  double angular_rad_s = 0;
  double linear_m_s2 = 0;
  double angular_rad_s2 = 0;
};

Limits read_limits(const Names& names) {
  constexpr std::string_view kLimitsMeaning =
      "largest speed (m/s), yaw rate (rad/s), acceleration (m/s^2) and yaw acceleration (rad/s^2), "
      "all above 0";
  const auto values = names.required_numeric("command_limits", 4, kLimitsMeaning);
  if (!std::all_of(values.begin(), values.end(), [](double value) { return value > 0; })) {
    throw ConfigurationError(
        names.where("command_limits"),
        with_code(Code::world, "numeric 'command_limits' is \"{}\"; write 4 numbers: {}",
                  fmt::join(values, " "), kLimitsMeaning));
  }
  return {values[0], values[1], values[2], values[3]};
}

double approach(double from, double to, double largest_step) {
  return from + std::clamp(to - from, -largest_step, largest_step);
}

}  // namespace

class Vehicle::Impl {
 public:
  /// `data` is that of a simulation that has not begun.
  Impl(mjModel& model, mjData& data, TimeNs timestep, const std::string& path, std::uint64_t seed)
      : model_(&model),
        data_(&data),
        names_(model, path),
        parts_(find_parts(model, names_)),
        timestep_(timestep),
        limits_(read_limits(names_)),
        laser_(model, names_, parts_),
        photodiodes_(model, names_),
        inertia_(timestep),
        arena_(read_arena(names_)),
        obstacles_(place_obstacles(*model_, *data_, names_, arena_, seed)),
        cue_place_(place_cue(*model_, *data_, names_, seed)),
        coverage_(arena_, obstacles_, parts_.radius_m) {
    mj_kinematics(model_, data_);
    goals_ = find_marks(*model_, *data_, names_, kGoalPrefix);
    lanes_ = find_marks(*model_, *data_, names_, kLanePrefix);
    place_vehicle(*data_, names_, parts_, arena_, obstacles_, lanes_, seed);
    mj_forward(model_, data_);
    inertia_.look(*data_, parts_);
    visit_here();
  }

  void command(double linear, double angular) {
    if (!std::isfinite(linear) || !std::isfinite(angular)) {
      ++invalid_commands_;
      linear = angular = 0;
    }
    wanted_linear_ = std::clamp(linear, -limits_.linear_m_s, limits_.linear_m_s);
    wanted_angular_ = std::clamp(angular, -limits_.angular_rad_s, limits_.angular_rad_s);
    if (wanted_linear_ != linear || wanted_angular_ != angular) ++clamped_commands_;
  }

  LaserScan scan(TimeNs time) const {
    place_parts();
    return laser_.scan(*model_, *data_, time);
  }

  Pose pose() const {
    const mjtNum* q = data_->qpos + parts_.qpos;
    const double heading =
        std::atan2(2 * (q[3] * q[6] + q[4] * q[5]), 1 - 2 * (q[5] * q[5] + q[6] * q[6]));
    return {q[0], q[1], heading};
  }

  Odometry odometry(TimeNs time) const {
    const mjtNum* velocity = data_->qvel + parts_.qvel;  // linear: world's frame; angular: own
    Odometry odometry{time, pose()};
    const double c = std::cos(odometry.pose.theta_rad);
    const double s = std::sin(odometry.pose.theta_rad);
    odometry.linear_x_m_s = c * velocity[0] + s * velocity[1];
    odometry.linear_y_m_s = c * velocity[1] - s * velocity[0];
    odometry.angular_z_rad_s = velocity[5];
    return odometry;
  }

  Imu imu(TimeNs time) const { return inertia_.read(*model_, *data_, parts_, time); }

  std::optional<Light> light(TimeNs time) const {
    if (!photodiodes_.has_lamps()) return std::nullopt;
    place_parts();
    return photodiodes_.read(*model_, *data_, time);
  }

  Mount laser_mount() const {
    return mount_of(model_->site_pos + 3 * parts_.site, model_->site_quat + 4 * parts_.site);
  }

  std::optional<Mount> camera_mount() const {
    const int camera = mj_name2id(model_, mjOBJ_CAMERA, "camera");
    if (camera < 0) return std::nullopt;
    // MuJoCo's cameras look along -z, y up: half a turn about x from the optical frame.
    constexpr mjtNum kHalfTurn[4] = {0, 1, 0, 0};
    mjtNum optical[4];
    mju_mulQuat(optical, model_->cam_quat + 4 * camera, kHalfTurn);
    return mount_of(model_->cam_pos + 3 * camera, optical);
  }

  /// Since it was made: the mean speed is not known here.
  Statistics statistics() const {
    Statistics result;
    result.collisions = collisions_.count();
    result.distance_m = distance_m_;
    result.free_cells = coverage_.free_cells();
    result.visited_cells = coverage_.visited_cells();
    result.coverage = result.free_cells == 0 ? 0
                                             : static_cast<double>(result.visited_cells) /
                                                   static_cast<double>(result.free_cells);
    result.invalid_commands = invalid_commands_;
    result.clamped_commands = clamped_commands_;
    return result;
  }

  std::uint64_t collisions() const { return collisions_.count(); }
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }
  const Arena& arena() const { return arena_; }
  const Parts& parts() const { return parts_; }
  int cue_place() const { return cue_place_; }
  const std::vector<Obstacle>& goals() const { return goals_; }
  const std::vector<Obstacle>& lanes() const { return lanes_; }

  void turn_wheels() {
    before_ = pose();
    const double dt = to_seconds(timestep_);
    linear_ = approach(linear_, wanted_linear_, limits_.linear_m_s2 * dt);
    angular_ = approach(angular_, wanted_angular_, limits_.angular_rad_s2 * dt);
    const double turn = angular_ * parts_.half_effective_track_m;
    for (std::size_t i = 0; i < parts_.actuator.size(); ++i) {
      const bool left = i % 2 == 0;
      data_->ctrl[parts_.actuator[i]] =
          (left ? linear_ - turn : linear_ + turn) / parts_.wheel_radius_m;
    }
  }

  /// After a physics step.
  void look(TimeNs time) {
    collisions_.look(*model_, *data_, parts_, time);
    inertia_.look(*data_, parts_);
    const Pose after = pose();
    distance_m_ += std::hypot(after.x_m - before_.x_m, after.y_m - before_.y_m);
    visit_here();
  }

 private:
  static Mount mount_of(const mjtNum* position, const mjtNum* attitude) {
    return {{position[0], position[1], position[2]},
            {attitude[0], attitude[1], attitude[2], attitude[3]}};
  }

  /// A step leaves positions of bodies, sites and geoms as they were before it. mj_kinematics()
  /// makes them those of now, but normalises the quaternions of qpos: what is read would change
  /// what follows.
  void place_parts() const {
    const std::vector<mjtNum> places(data_->qpos, data_->qpos + model_->nq);
    mj_kinematics(model_, data_);
    std::ranges::copy(places, data_->qpos);
  }

  void visit_here() {
    const Pose here = pose();
    coverage_.visit(here.x_m, here.y_m);
  }

  mjModel* model_;
  mjData* data_;
  Names names_;
  Parts parts_;
  TimeNs timestep_;
  Limits limits_;
  Laser laser_;
  Photodiodes photodiodes_;
  Inertia inertia_;
  Arena arena_;
  std::vector<Obstacle> obstacles_;
  std::vector<Obstacle> goals_;
  std::vector<Obstacle> lanes_;
  int cue_place_ = 0;
  Coverage coverage_;
  Collisions collisions_;
  Pose before_;  // the last physics step
  double distance_m_ = 0;
  double wanted_linear_ = 0;
  double wanted_angular_ = 0;
  double linear_ = 0;  // what the wheels are set to: follows what is wanted within the limits
  double angular_ = 0;
  std::uint64_t invalid_commands_ = 0;
  std::uint64_t clamped_commands_ = 0;
};

Vehicle::Vehicle(const Options& options)
    : Simulation({options.world}, kLongestTimestep),
      impl_(std::make_unique<Impl>(own_model(), own_data(), timestep(), world(), options.seed)) {}
Vehicle::~Vehicle() = default;

void Vehicle::reset(std::uint64_t seed) {
  before_reset_ = statistics();
  Simulation::reset();
  impl_ = std::make_unique<Impl>(own_model(), own_data(), timestep(), world(), seed);
}

void Vehicle::command(double linear_m_s, double angular_rad_s) {
  impl_->command(linear_m_s, angular_rad_s);
}
void Vehicle::command(std::span<const double> numbers) {
  impl_->command(numbers[0], numbers[1]);
}
void Vehicle::before_physics() {
  impl_->turn_wheels();
}
void Vehicle::after_physics(TimeNs end) {
  impl_->look(end);
}
LaserScan Vehicle::scan() const {
  return impl_->scan(time());
}
Odometry Vehicle::odometry() const {
  return impl_->odometry(time());
}
Imu Vehicle::imu() const {
  return impl_->imu(time());
}
std::optional<Light> Vehicle::light() const {
  return impl_->light(time());
}
Mount Vehicle::laser_mount() const {
  return impl_->laser_mount();
}
std::optional<Mount> Vehicle::camera_mount() const {
  return impl_->camera_mount();
}
Pose Vehicle::pose() const {
  return impl_->pose();
}
Statistics Vehicle::statistics() const {
  Statistics all = impl_->statistics();
  all.collisions += before_reset_.collisions;
  all.distance_m += before_reset_.distance_m;
  all.invalid_commands += before_reset_.invalid_commands;
  all.clamped_commands += before_reset_.clamped_commands;
  all.mean_speed_m_s = time() > 0 ? all.distance_m / to_seconds(time()) : 0;
  return all;
}
std::uint64_t Vehicle::collisions_since_reset() const {
  return impl_->collisions();
}
const std::vector<Obstacle>& Vehicle::obstacles() const {
  return impl_->obstacles();
}
const Arena& Vehicle::arena() const {
  return impl_->arena();
}
double Vehicle::radius_m() const {
  return impl_->parts().radius_m;
}
double Vehicle::half_effective_track_m() const {
  return impl_->parts().half_effective_track_m;
}
int Vehicle::cue_place() const {
  return impl_->cue_place();
}
const std::vector<Obstacle>& Vehicle::goals() const {
  return impl_->goals();
}
const std::vector<Obstacle>& Vehicle::lanes() const {
  return impl_->lanes();
}
std::optional<LanePosition> Vehicle::lane_position() const {
  return find_lane_position(lanes(), pose());
}

}  // namespace spikeloop::vehicle
