// Where the obstacles and the vehicle stand when a run begins.
#pragma once

#include <cstdint>
#include <vector>

#include "model.hpp"

namespace spikeloop::vehicle {

/// Puts the mocap obstacles and the vehicle in place and returns every obstacle's footprint.
/// @throws ConfigurationError when an obstacle is of another shape than box or cylinder, when they
/// cannot be placed, or when the vehicle's start is not free.
std::vector<Obstacle> lay_out(const mjModel& model, mjData& data, const Names& names,
                              const Parts& parts, const Arena& arena, std::uint64_t seed);

/// Puts the mocap body `cue` at the one of the numerics `cue_place_1`, `cue_place_2`, ... (x, y,
/// heading) that the seed draws, and says which; 0: there is no cue.
/// @throws ConfigurationError: a cue without places, or one that is not a mocap body.
int place_cue(const mjModel& model, mjData& data, const Names& names, std::uint64_t seed);

/// The boxes `goal_*` on the floor, seen from above, where mj_forward() has put them.
std::vector<Obstacle> find_goals(const mjModel& model, const mjData& data);

/// Reads numeric `arena`.
Arena read_arena(const Names& names);

/// Distance from a point to the nearest wall or obstacle; 0 or less on or outside a wall.
double clearance_m(const Arena& arena, const std::vector<Obstacle>& obstacles, double x, double y);

}  // namespace spikeloop::vehicle
