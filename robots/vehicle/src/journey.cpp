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
      const double x = arena.min_x_m + (static_cast<double>(column) + 0.5) * kCell;
      const double y = arena.min_y_m + (static_cast<double>(row) + 0.5) * kCell;
      const bool is_free = clearance_m(arena, obstacles, x, y) >= vehicle_radius_m;
      free_[row * columns_ + column] = is_free;
      free_cells_ += is_free ? 1 : 0;
    }
  }
}

void Coverage::visit(double x, double y) {
  if (x < arena_.min_x_m || x >= arena_.max_x_m || y < arena_.min_y_m || y >= arena_.max_y_m) {
    return;
  }
  const auto column = static_cast<std::size_t>((x - arena_.min_x_m) / kCell);
  const auto row = static_cast<std::size_t>((y - arena_.min_y_m) / kCell);
  const std::size_t cell = row * columns_ + column;
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
