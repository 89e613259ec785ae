#include "inertia.hpp"

#include <algorithm>

namespace spikeloop::vehicle {
namespace {

/// A wheel that slips is stuck and free in turn, step by step: an acceleration of one step says
/// nothing. Over a window the mean is that of the motion, and adds up to the velocity.
constexpr TimeNs kWindow = 10'000'000;

}  // namespace

Inertia::Inertia(TimeNs timestep)
    : steps_(static_cast<std::size_t>(std::max<TimeNs>(1, kWindow / timestep))),
      timestep_s_(to_seconds(timestep)) {}

void Inertia::look(const mjData& data, const Parts& parts) {
  const mjtNum* velocity = data.qvel + parts.qvel;
  velocities_.push_back({velocity[0], velocity[1], velocity[2]});
  if (velocities_.size() > steps_ + 1) velocities_.pop_front();
}

Imu Inertia::read(const mjModel& model, const mjData& data, const Parts& parts,
                  TimeNs stamp) const {
  Imu imu;
  imu.stamp = stamp;
  const mjtNum* attitude = data.qpos + parts.qpos + 3;
  std::copy_n(attitude, 4, imu.orientation.begin());
  std::copy_n(data.qvel + parts.qvel + 3, 3, imu.angular_velocity_rad_s.begin());
  Vector3 felt{};  // in the arena's frame
  for (std::size_t i = 0; i < 3; ++i) felt[i] = -model.opt.gravity[i];
  if (velocities_.size() > 1) {
    const double window = static_cast<double>(velocities_.size() - 1) * timestep_s_;
    for (std::size_t i = 0; i < 3; ++i) {
      felt[i] += (velocities_.back()[i] - velocities_.front()[i]) / window;
    }
  }
  mjtNum back[4];
  mju_negQuat(back, attitude);
  mju_rotVecQuat(imu.linear_acceleration_m_s2.data(), felt.data(), back);
  return imu;
}

}  // namespace spikeloop::vehicle
