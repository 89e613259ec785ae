// The vehicle: four wheels, steered by skidding, with a laser, in a MuJoCo world.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/vehicle/sensors.hpp"
#include "spikeloop/vehicle/simulation.hpp"

namespace spikeloop::vehicle {

/// A position on the floor and a heading (counterclockwise from x, in (-pi, pi]).
struct Pose {
  double x_m = 0;
  double y_m = 0;
  double theta_rad = 0;
};

/// One sweep of the laser, in the fields of sensor_msgs/LaserScan. Beam i looks at angle
/// angle_min + i * angle_increment, counterclockwise from straight ahead. All beams are of one
/// instant. As REP 117 has it: +inf where nothing is within range_max, -inf where something is
/// nearer than range_min.
struct LaserScan {
  TimeNs stamp = 0;
  float angle_min_rad = 0;
  float angle_max_rad = 0;
  float angle_increment_rad = 0;
  float scan_time_s = 0;  ///< time between two scans as the world wants them published
  float range_min_m = 0;
  float range_max_m = 0;
  std::vector<float> ranges_m;
};

/// True pose in the arena's frame, and the velocity in the vehicle's own frame (x ahead, y left).
struct Odometry {
  TimeNs stamp = 0;
  Pose pose;
  double linear_x_m_s = 0;
  double linear_y_m_s = 0;
  double angular_z_rad_s = 0;
};

/// Totals since the start; those of the coverage since the last reset.
struct Statistics {
  /// Contact episodes of the body or the wheels with one wall or obstacle; an episode ends when
  /// they have not touched for 0.5 s.
  std::uint64_t collisions = 0;
  double distance_m = 0;      ///< length of the path of the body's centre
  double mean_speed_m_s = 0;  ///< distance over simulated time; 0 at the start
  /// Share of the free cells (0.5 m x 0.5 m, counted from the arena's corner) that the body's
  /// centre has been in. A cell is free when its centre is at least the vehicle's radius (farthest
  /// point of the vehicle from its centre) away from every wall and obstacle.
  double coverage = 0;
  std::uint64_t free_cells = 0;
  std::uint64_t visited_cells = 0;
  std::uint64_t invalid_commands = 0;  ///< commands with a NaN or an infinity: taken as stop
  std::uint64_t clamped_commands = 0;  ///< commands beyond the vehicle's limits
};

/// Footprint of an obstacle: upright box (turned by theta) or cylinder.
struct Obstacle {
  enum class Shape { box, cylinder };
  std::string name;
  Shape shape = Shape::box;
  double x_m = 0;
  double y_m = 0;
  double theta_rad = 0;
  double half_x_m = 0;  ///< box
  double half_y_m = 0;  ///< box
  double radius_m = 0;  ///< cylinder
  double height_m = 0;  ///< of its top above z = 0
  /// Distance of a point from the footprint; 0 inside.
  double distance_m(double x, double y) const;
};

/// Of the vehicle's centre relative to a lane's centre line, as seen along the one of the line's
/// two directions that is nearer to the vehicle's heading. Of several lanes it is the one with the
/// smallest ratio of distance and width.
struct LanePosition {
  double distance_m = 0;    ///< above 0: the vehicle is to the left of the line
  double angle_rad = 0;     ///< from -pi/2 to pi/2; above 0: the vehicle is turned to the left
  double half_width_m = 0;  ///< of the lane
  bool is_inside() const { return std::abs(distance_m) <= half_width_m; }
};

/// Inner faces of the arena's walls.
struct Arena {
  double min_x_m = 0;
  double min_y_m = 0;
  double max_x_m = 0;
  double max_y_m = 0;
};

struct Options {
  /// Path of an MJCF file, or the name of a shipped one. See find_world.
  std::string world = "arena.xml";
  /// Places the obstacles and the start pose.
  std::uint64_t seed = 1;
};

/// A world read from MJCF must name these things:
///   body `vehicle` with a free joint, its middle the vehicle's centre; site `laser` on it (x
///     ahead); four hinge joints and velocity actuators `wheel_front_left`, `wheel_front_right`,
///     `wheel_rear_left`, `wheel_rear_right` (all in the shipped spikeloop_vehicle.xml);
///   numeric `command_limits` = speed (m/s), yaw rate (rad/s), acceleration (m/s^2), yaw
///     acceleration (rad/s^2); numeric `laser` = beams, first and last angle (rad), smallest and
///     largest range (m), scans per second (both in the same file);
///   geom `floor`; everything else that does not belong to the vehicle can be collided with;
///   numeric `arena` = min x, min y, max x, max y of the walls' inner faces;
///   bodies `obstacle_*` of upright boxes and cylinders: those with mocap="true" are put in place
///     by the seed, with at least numeric `passage` (0.9 m) between circles around them and to the
///     walls; the others stay where the file says;
///   numeric `start` = x, y, heading fixes the start pose; without it the seed draws one whose
///     centre is at least numeric `start_clearance` (0.45 m) away from everything.
/// It may name:
///   sites `lamp_*`, each with a numeric of its name: a lamp's luminous intensity (cd). A body that
///     holds one does not stand in its light. The sites `light_left` and `light_right` on the
///     vehicle are the photodiodes, x along their normals;
///   camera `camera` on the vehicle;
///   boxes `goal_*` on the floor: goals of an episode;
///   boxes `lane_*` on the floor: parts of a lane, whose centre line is parallel to the longer
///   sides.
///     Without numeric `start` the vehicle starts on it, in one of the two directions, and at least
///     numeric `start_clearance` away from its ends;
///   mocap body `cue`, which the seed puts at one of the numerics `cue_place_1`, `cue_place_2`, ...
///     (x, y, heading).
/// The draws come from RandomStream(seed, "arena"): the same seed gives the same world.
///
/// Skid steering: the wheels of a side turn at the same speed, v -+ w * h, where h is half the
/// effective track. In a turn on the spot every wheel slips with the same speed, so with equal
/// loads and Coulomb friction the yaw moment vanishes when sum((w |y| - u) |y| + w x^2) = 0 over
/// the wheels at (x, y) with rim speed u: h = u / w = sum(x^2 + y^2) / sum(|y|).
class Vehicle : public Simulation {
 public:
  /// @throws FileError when the world cannot be read; ConfigurationError when it is not MJCF, lacks
  /// one of the things above, or cannot be laid out.
  explicit Vehicle(const Options& options);
  ~Vehicle() override;

  /// Begins anew, now, in the world of another seed; statistics go on.
  void reset(std::uint64_t seed);

  /// Holds from now on: speed ahead and yaw rate (counterclockwise), clamped to the world's
  /// `command_limits`, which also limit how fast the wheels are brought there. A command that is
  /// not finite stops the vehicle and is counted.
  void command(double linear_m_s, double angular_rad_s);
  /// The same: {speed ahead, yaw rate}.
  void command(std::span<const double> numbers) override;
  const Vehicle* vehicle() const override { return this; }

  LaserScan scan() const;
  Odometry odometry() const;
  Imu imu() const;
  /// Nothing when the world has no lamps.
  std::optional<Light> light() const;
  Mount laser_mount() const;
  /// Of the camera's optical frame: x to the right of the picture, y down, z into it (REP 103).
  /// Nothing when the vehicle has no camera.
  std::optional<Mount> camera_mount() const;
  Pose pose() const;
  Statistics statistics() const;
  const std::vector<Obstacle>& obstacles() const;
  const Arena& arena() const;
  /// Farthest point of the vehicle from its centre, seen from above.
  double radius_m() const;
  /// Half the effective track of the skid steering.
  double half_effective_track_m() const;
  /// Contact episodes, as in Statistics, since the start or the last reset.
  std::uint64_t collisions_since_reset() const;
  /// Where the seed has put the cue, from 1; 0: the world has none.
  int cue_place() const;
  const std::vector<Obstacle>& goals() const;
  const std::vector<Obstacle>& lanes() const;
  /// Nothing when the world has no lanes.
  std::optional<LanePosition> lane_position() const;

 private:
  void before_physics() override;
  void after_physics(TimeNs end) override;

  class Impl;
  std::unique_ptr<Impl> impl_;
  Statistics before_reset_;
};

}  // namespace spikeloop::vehicle
