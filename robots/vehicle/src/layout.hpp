// Where the obstacles and the vehicle stand when a run begins.
#pragma once

#include <cstdint>
#include <vector>

#include "model.hpp"

namespace spikeloop::vehicle {

/// Puts the mocap obstacles in place and returns every obstacle's footprint.
/// @throws ConfigurationError when an obstacle is of another shape than box or cylinder, or when
/// they cannot be placed.
std::vector<Obstacle> place_obstacles(const mjModel& model, mjData& data, const Names& names,
                                      const Arena& arena, std::uint64_t seed);

/// Puts the vehicle at the numeric `start`, or where the seed draws it: on the centre line of a
/// lane, if there are lanes.
/// @throws ConfigurationError when the start is not free, or when there is no free place.
void place_vehicle(mjData& data, const Names& names, const Parts& parts, const Arena& arena,
                   const std::vector<Obstacle>& obstacles, const std::vector<Obstacle>& lanes,
                   std::uint64_t seed);

/// Puts the mocap body `cue` at the one of the numerics `cue_place_1`, `cue_place_2`, ... (x, y,
/// heading) that the seed draws, and says which; 0: there is no cue.
/// @throws ConfigurationError: a cue without places, or one that is not a mocap body.
int place_cue(const mjModel& model, mjData& data, const Names& names, std::uint64_t seed);

/// Reads numeric `arena`.
Arena read_arena(const Names& names);

/// Distance from a point to the nearest wall or obstacle; 0 or less on or outside a wall.
double clearance_m(const Arena& arena, const std::vector<Obstacle>& obstacles, double x, double y);

}  // namespace spikeloop::vehicle
