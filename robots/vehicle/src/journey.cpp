#include "journey.hpp"

#include <algorithm>
#include <cmath>

#include "layout.hpp"

namespace spikeloop::vehicle {
namespace {

constexpr double kCell = 0.5;  // m

// A border cell cut off by the wall counts when its cut-off centre is inside.
std::size_t cells_along(double length) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(length / kCell - 1e-9)));
}

/// Index of the cell at a distance (m) from the arena's edge; the nearest one if it is outside.
std::size_t cell_at(double distance, std::size_t cells) {
  return static_cast<std::size_t>(
      std::clamp(distance / kCell, 0.0, static_cast<double>(cells - 1)));
}

}  // namespace

Coverage::Coverage(const Arena& arena, const std::vector<Obstacle>& obstacles,
                   double vehicle_radius_m)
    : arena_(arena),
      columns_(cells_along(arena.max_x_m - arena.min_x_m)),
      rows_(cells_along(arena.max_y_m - arena.min_y_m)),
      free_(columns_ * rows_),
      visited_(columns_ * rows_) {
  for (std::size_t row = 0; row < rows_; ++row) {
    for (std::size_t column = 0; column < columns_; ++column) {
      const auto [x, y] = centre(column, row);
      free_[row * columns_ + column] = clearance_m(arena, {}, x, y) >= vehicle_radius_m;
    }
  }
  for (const Obstacle& obstacle : obstacles) occupy(obstacle, vehicle_radius_m);
  free_cells_ = static_cast<std::uint64_t>(std::ranges::count(free_, true));
}

std::pair<double, double> Coverage::centre(std::size_t column, std::size_t row) const {
  return {arena_.min_x_m + (static_cast<double>(column) + 0.5) * kCell,
          arena_.min_y_m + (static_cast<double>(row) + 0.5) * kCell};
}

/// Visits only cells near the obstacle: a world may have many cells and many obstacles.
void Coverage::occupy(const Obstacle& obstacle, double vehicle_radius_m) {
  const double reach =
      std::max(obstacle.radius_m, std::hypot(obstacle.half_x_m, obstacle.half_y_m)) +
      vehicle_radius_m;
  const std::size_t last_column = cell_at(obstacle.x_m + reach - arena_.min_x_m, columns_);
  const std::size_t last_row = cell_at(obstacle.y_m + reach - arena_.min_y_m, rows_);
  for (std::size_t row = cell_at(obstacle.y_m - reach - arena_.min_y_m, rows_); row <= last_row;
       ++row) {
    for (std::size_t column = cell_at(obstacle.x_m - reach - arena_.min_x_m, columns_);
         column <= last_column; ++column) {
      const auto [x, y] = centre(column, row);
      if (obstacle.distance_m(x, y) < vehicle_radius_m) free_[row * columns_ + column] = false;
    }
  }
}

void Coverage::visit(double x, double y) {
  if (!(x >= arena_.min_x_m && x < arena_.max_x_m && y >= arena_.min_y_m && y < arena_.max_y_m)) {
    return;
  }
  const std::size_t cell =
      cell_at(y - arena_.min_y_m, rows_) * columns_ + cell_at(x - arena_.min_x_m, columns_);
  if (free_[cell] && !visited_[cell]) {
    visited_[cell] = true;
    ++visited_cells_;
  }
}

void Collisions::look(const mjModel& model, const mjData& data, const Parts& parts, TimeNs time) {
  for (int i = 0; i < data.ncon; ++i) {
    const mjContact& contact = data.contact[i];
    const bool first = parts.own_geom[static_cast<std::size_t>(contact.geom1)];
    const bool second = parts.own_geom[static_cast<std::size_t>(contact.geom2)];
    if (first == second || contact.dist > 0) continue;
    const int geom = first ? contact.geom2 : contact.geom1;
    if (geom == parts.floor) continue;
    const int body = model.geom_bodyid[geom];
    counter_.touch(body != 0 ? body : -1 - geom, time);
  }
}

}  // namespace spikeloop::vehicle
