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
#include "model.hpp"
#include "photodiodes.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::vehicle {
namespace {

constexpr double kLongestTimestep = 0.01;  // s; wheels would bounce

TimeNs read_timestep(const mjModel& model, const Names& names) {
  const double seconds = model.opt.timestep;
  if (!(seconds >= 1e-6 && seconds <= kLongestTimestep)) {
    throw ConfigurationError(
        Location{names.path()},
        with_code(Code::world,
                  "has a timestep of {} s; write <option timestep=\"0.002\"/>, at most {}", seconds,
                  kLongestTimestep));
  }
  return tick_from_seconds(seconds);
}

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
        Location{names.path()},
        with_code(Code::world, "numeric 'command_limits' is \"{}\"; write 4 numbers: {}",
                  fmt::join(values, " "), kLimitsMeaning));
  }
  return {values[0], values[1], values[2], values[3]};
}

double approach(double from, double to, double largest_step) {
  return from + std::clamp(to - from, -largest_step, largest_step);
}

DataPointer make_data(const mjModel& model) {
  return DataPointer(mj_makeData(&model));
}

}  // namespace

class Vehicle::Impl {
 public:
  explicit Impl(const Options& options)
      : path_(find_world(options.world)),
        model_(load_model(path_)),
        names_(*model_, path_),
        parts_(find_parts(*model_, names_)),
        timestep_(read_timestep(*model_, names_)),
        limits_(read_limits(names_)),
        laser_(*model_, names_, parts_),
        photodiodes_(*model_, names_),
        inertia_(timestep_),
        data_(make_data(*model_)),
        arena_(read_arena(names_)),
        obstacles_(lay_out(*model_, *data_, names_, parts_, arena_, options.seed)),
        cue_place_(place_cue(*model_, *data_, names_, options.seed)),
        coverage_(arena_, obstacles_, parts_.radius_m) {
    mj_forward(model_.get(), data_.get());
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

  void step(TimeNs dt) {
    if (dt <= 0) {
      throw ConfigurationError(with_code(
          Code::world, "cannot advance the vehicle by {}; write a time above 0", format_time(dt)));
    }
    time_ += dt;
    while (physics_time_ + timestep_ <= time_) physics_step();
  }

  LaserScan scan() const {
    place_parts();
    return laser_.scan(*model_, *data_, time_);
  }

  Pose pose() const {
    const mjtNum* q = data_->qpos + parts_.qpos;
    const double heading =
        std::atan2(2 * (q[3] * q[6] + q[4] * q[5]), 1 - 2 * (q[5] * q[5] + q[6] * q[6]));
    return {q[0], q[1], heading};
  }

  Odometry odometry() const {
    const mjtNum* velocity = data_->qvel + parts_.qvel;  // linear: world's frame; angular: own
    Odometry odometry{time_, pose()};
    const double c = std::cos(odometry.pose.theta_rad);
    const double s = std::sin(odometry.pose.theta_rad);
    odometry.linear_x_m_s = c * velocity[0] + s * velocity[1];
    odometry.linear_y_m_s = c * velocity[1] - s * velocity[0];
    odometry.angular_z_rad_s = velocity[5];
    return odometry;
  }

  Imu imu() const { return inertia_.read(*model_, *data_, parts_, time_); }

  JointStates joint_states() const {
    JointStates states;
    states.stamp = time_;
    for (std::size_t i = 0; i < parts_.joint.size(); ++i) {
      states.names.push_back(names_.joint(parts_.joint[i]));
      states.positions_rad.push_back(data_->qpos[model_->jnt_qposadr[parts_.joint[i]]]);
      states.velocities_rad_s.push_back(data_->qvel[model_->jnt_dofadr[parts_.joint[i]]]);
      states.torques_n_m.push_back(data_->actuator_force[parts_.actuator[i]]);
    }
    return states;
  }

  std::optional<Light> light() const {
    if (!photodiodes_.has_lamps()) return std::nullopt;
    place_parts();
    return photodiodes_.read(*model_, *data_, time_);
  }

  Mount laser_mount() const {
    return mount_of(model_->site_pos + 3 * parts_.site, model_->site_quat + 4 * parts_.site);
  }

  std::optional<Mount> camera_mount() const {
    const int camera = mj_name2id(model_.get(), mjOBJ_CAMERA, "camera");
    if (camera < 0) return std::nullopt;
    // MuJoCo's cameras look along -z, y up: half a turn about x from the optical frame.
    constexpr mjtNum kHalfTurn[4] = {0, 1, 0, 0};
    mjtNum optical[4];
    mju_mulQuat(optical, model_->cam_quat + 4 * camera, kHalfTurn);
    return mount_of(model_->cam_pos + 3 * camera, optical);
  }

  Statistics statistics() const {
    Statistics result;
    result.collisions = collisions_.count();
    result.distance_m = distance_m_;
    result.mean_speed_m_s = time_ > 0 ? distance_m_ / to_seconds(time_) : 0;
    result.free_cells = coverage_.free_cells();
    result.visited_cells = coverage_.visited_cells();
    result.coverage = result.free_cells == 0 ? 0
                                             : static_cast<double>(result.visited_cells) /
                                                   static_cast<double>(result.free_cells);
    result.invalid_commands = invalid_commands_;
    result.clamped_commands = clamped_commands_;
    return result;
  }

  TimeNs time() const { return time_; }
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }
  const Arena& arena() const { return arena_; }
  const Parts& parts() const { return parts_; }
  const std::string& path() const { return path_; }
  int cue_place() const { return cue_place_; }
  const mjModel& model() const { return *model_; }
  const mjData& data() const { return *data_; }

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
    mj_kinematics(model_.get(), data_.get());
    std::ranges::copy(places, data_->qpos);
  }

  void turn_wheels() {
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

  void physics_step() {
    const Pose before = pose();
    turn_wheels();
    mj_step(model_.get(), data_.get());
    physics_time_ += timestep_;
    for (const int warning : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC}) {
      if (data_->warning[warning].number > 0) {
        throw NodeError("vehicle",
                        fmt::format("the physics of {} became unstable at {}; write a smaller "
                                    "<option timestep=\"...\"/> (now {}) or weaker actuators",
                                    path_, format_time(physics_time_), format_time(timestep_)));
      }
    }
    collisions_.look(*model_, *data_, parts_, physics_time_);
    inertia_.look(*data_, parts_);
    const Pose after = pose();
    distance_m_ += std::hypot(after.x_m - before.x_m, after.y_m - before.y_m);
    visit_here();
  }

  void visit_here() {
    const Pose here = pose();
    coverage_.visit(here.x_m, here.y_m);
  }

  std::string path_;
  ModelPointer model_;
  Names names_;
  Parts parts_;
  TimeNs timestep_;
  Limits limits_;
  Laser laser_;
  Photodiodes photodiodes_;
  Inertia inertia_;
  DataPointer data_;
  Arena arena_;
  std::vector<Obstacle> obstacles_;
  int cue_place_ = 0;
  Coverage coverage_;
  Collisions collisions_;
  TimeNs time_ = 0;
  TimeNs physics_time_ = 0;
  double distance_m_ = 0;
  double wanted_linear_ = 0;
  double wanted_angular_ = 0;
  double linear_ = 0;  // what the wheels are set to: follows what is wanted within the limits
  double angular_ = 0;
  std::uint64_t invalid_commands_ = 0;
  std::uint64_t clamped_commands_ = 0;
};

Vehicle::Vehicle(const Options& options) : impl_(std::make_unique<Impl>(options)) {}
Vehicle::~Vehicle() = default;
Vehicle::Vehicle(Vehicle&&) noexcept = default;
Vehicle& Vehicle::operator=(Vehicle&&) noexcept = default;

void Vehicle::command(double linear_m_s, double angular_rad_s) {
  impl_->command(linear_m_s, angular_rad_s);
}
void Vehicle::step(TimeNs dt) {
  impl_->step(dt);
}
TimeNs Vehicle::time() const {
  return impl_->time();
}
LaserScan Vehicle::scan() const {
  return impl_->scan();
}
Odometry Vehicle::odometry() const {
  return impl_->odometry();
}
Imu Vehicle::imu() const {
  return impl_->imu();
}
JointStates Vehicle::joint_states() const {
  return impl_->joint_states();
}
std::optional<Light> Vehicle::light() const {
  return impl_->light();
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
  return impl_->statistics();
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
const std::string& Vehicle::world() const {
  return impl_->path();
}
int Vehicle::cue_place() const {
  return impl_->cue_place();
}
const mjModel_& Vehicle::model() const {
  return impl_->model();
}
const mjData_& Vehicle::data() const {
  return impl_->data();
}

}  // namespace spikeloop::vehicle
