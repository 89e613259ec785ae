// What the vehicle measures beside its laser and its odometry.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"

namespace spikeloop::vehicle {

using Vector3 = std::array<double, 3>;
/// w, x, y, z, of length 1.
using Quaternion = std::array<double, 4>;

/// An inertial unit, in its own frame, as REP 145 has it: at rest on the floor it measures +9.81
/// m/s^2 upwards. That of the vehicle is in its middle (x ahead, y left, z up).
struct Imu {
  TimeNs stamp = 0;
  Quaternion orientation{1, 0, 0, 0};  ///< in the world
  Vector3 angular_velocity_rad_s{};
  /// Without gravity's own pull: what a mass on springs feels. That of the vehicle is the mean over
  /// the last 10 ms.
  Vector3 linear_acceleration_m_s2{};
};

/// Joints of one degree of freedom: hinges (rad, rad/s, N m) and slides (m, m/s, N).
struct JointStates {
  TimeNs stamp = 0;
  std::vector<std::string> names;  ///< "wheel_front_left", ...
  std::vector<double> positions;
  std::vector<double> velocities;
  std::vector<double> efforts;  ///< of their actuators
};

/// Two photodiodes. Each measures the illuminance
///
///     E = sum over the lamps of  I cos(a) / d^2,
///
/// I a lamp's luminous intensity (cd), d its distance (m), a the angle between the diode's normal
/// and the lamp (Lambert's law); 0 from behind, and from a lamp that something stands in front of.
struct Light {
  TimeNs stamp = 0;
  double left_lux = 0;
  double right_lux = 0;
};

/// Where something sits on the vehicle, in the vehicle's frame.
struct Mount {
  Vector3 position_m{};
  Quaternion orientation{1, 0, 0, 0};
};

}  // namespace spikeloop::vehicle
