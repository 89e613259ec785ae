// A robot that MuJoCo simulates, as a library that the caller advances: joints, actuators and
// sensors of any MJCF file by their names. No ROS, no clock, no threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/vehicle/sensors.hpp"

struct mjModel_;  // MuJoCo's, for what draws it
struct mjData_;

namespace spikeloop::vehicle {

class Vehicle;

/// What the number of an actuator sets.
enum class Quantity {
  position,  ///< <position>: rad or m
  velocity,  ///< <velocity>: rad/s or m/s
  effort     ///< <motor> and all others, in the unit of its control
};

struct Actuator {
  std::string name;  ///< without one in the file: the name of its joint, or "actuator_0", ...
  Quantity quantity = Quantity::effort;
};

/// A <sensor> of the file.
struct ModelSensor {
  std::string name;  ///< without one in the file: "sensor_0", ...
  std::size_t width = 0;
};

enum class Named { camera, keyframe };

/// A site with an <accelerometer> and a <gyro>.
struct InertialUnit {
  std::string site;
  std::size_t accelerometer = 0;  ///< index in sensors()
  std::size_t gyro = 0;
};

struct ModelOptions {
  /// Path of an MJCF file, or the name of a shipped one. See find_world.
  std::string file;
  /// <key> of the file that the simulation starts from; empty: the file's own positions.
  std::string keyframe{};
};

class Simulation {
 public:
  /// @throws FileError when the file cannot be read; ConfigurationError when it is not MJCF, its
  /// timestep is longer than that, or it does not have the keyframe.
  explicit Simulation(const ModelOptions& options, double longest_timestep_s = 0.1);
  virtual ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Advances by `dt` > 0. Physics runs in steps of the file's own timestep; a remainder is kept
  /// for the next call, so the trajectory does not depend on how a time is divided.
  /// @throws NodeError when the physics becomes unstable.
  void step(TimeNs dt);
  TimeNs time() const;
  const std::string& world() const;  ///< path of the file that was read

  /// All hinge and slide joints, in the file's order.
  JointStates joint_states() const;
  const std::vector<ModelSensor>& sensors() const;
  /// What a sensor measures now, as MuJoCo's documentation describes it (XML Reference, sensor).
  /// @param index in sensors()
  std::vector<double> read_sensor(std::size_t index) const;

  const std::vector<InertialUnit>& inertial_units() const;
  /// In the frame of its site; the orientation is that of the site in the world.
  /// @param index in inertial_units()
  Imu read_inertial_unit(std::size_t index) const;

  const std::vector<Actuator>& actuators() const;
  /// Numbers for the actuators, which hold from now on, or from the next physics step on, within
  /// their control ranges. An actuator whose number is not finite, or above 1e10, keeps the one
  /// before; at the start it has that of the keyframe, or 0.
  virtual void command(std::span<const double> numbers);

  /// Names of all cameras or keyframes that have one.
  std::vector<std::string> names_of(Named kind) const;

  /// The same robot with what only the vehicle has; null for any other.
  virtual const Vehicle* vehicle() const { return nullptr; }

  /// What MuJoCo makes pictures of. Positions that follow from the state are those before the last
  /// physics step.
  const mjModel_& model() const;
  const mjData_& data() const;

 protected:
  /// Around every physics step, which ends at `end`.
  virtual void before_physics() {}
  virtual void after_physics(TimeNs /*end*/) {}

  /// Back to the state of the beginning; time goes on.
  void reset();

  mjModel_& own_model();
  mjData_& own_data();
  TimeNs timestep() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// The path itself when such a file exists; else, for a bare file name, the shipped world of that
/// name, with or without its ".xml": in `worlds` of $SPIKELOOP_SHARE, or of share/spikeloop beside
/// or above the running program's directory.
/// @throws FileError naming the places that were searched.
std::string find_world(const std::string& name);

}  // namespace spikeloop::vehicle
