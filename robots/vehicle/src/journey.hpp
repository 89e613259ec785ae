// What is counted along the way: path, coverage and collisions.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "model.hpp"
#include "spikeloop/vehicle/collision_counter.hpp"

namespace spikeloop::vehicle {

/// Cells of 0.5 m that the vehicle's centre has been in.
class Coverage {
 public:
  Coverage(const Arena& arena, const std::vector<Obstacle>& obstacles, double vehicle_radius_m);
  void visit(double x, double y);
  std::uint64_t free_cells() const { return free_cells_; }
  std::uint64_t visited_cells() const { return visited_cells_; }

 private:
  std::pair<double, double> centre(std::size_t column, std::size_t row) const;
  /// Marks the cells whose centres are nearer to the obstacle than the vehicle's radius.
  void occupy(const Obstacle& obstacle, double vehicle_radius_m);

  Arena arena_;
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::vector<bool> free_;
  std::vector<bool> visited_;
  std::uint64_t free_cells_ = 0;
  std::uint64_t visited_cells_ = 0;
};

/// Collisions between the vehicle and everything but the floor.
class Collisions {
 public:
  /// Looks at the contacts of the physics step that ended at `time`.
  void look(const mjModel& model, const mjData& data, const Parts& parts, TimeNs time);
  std::uint64_t count() const { return counter_.count(); }

 private:
  CollisionCounter<int> counter_;  // of things: body, or -1 - geom for parts of the world body
};

}  // namespace spikeloop::vehicle
