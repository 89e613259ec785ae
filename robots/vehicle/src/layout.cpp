#include "layout.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "marks.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/random.hpp"

namespace spikeloop::vehicle {
namespace {

constexpr std::string_view kStream = "arena";
constexpr std::uint64_t kObstacles = 0;  // purposes of the random stream
constexpr std::uint64_t kStart = 1;
constexpr std::uint64_t kCue = 2;
constexpr int kTriesPerObstacle = 100;
constexpr int kLayouts = 2000;
constexpr int kTriesForStart = 20000;
constexpr std::size_t kComparisons = 200'000'000;  // comparisons of obstacles, in all layouts
constexpr double kLongestSide = 1000;             // m

struct Circle {
  double x = 0;
  double y = 0;
  double radius = 0;
  double heading = 0;
};

// A body that holds the geoms of one obstacle.
struct ObstacleBody {
  int id = -1;
  int mocap = -1;
  Circle circle;  // around all its geoms, at the place the file says
};

double heading_of(const mjtNum* quaternion) {
  return 2 * std::atan2(quaternion[3], quaternion[0]);
}

bool is_upright(const mjtNum* quaternion) {
  return std::hypot(quaternion[1], quaternion[2]) < 1e-6;
}

double footprint_radius(const mjModel& model, int geom, const Names& names) {
  const int body = model.geom_bodyid[geom];
  const mjtNum* size = model.geom_size + 3 * geom;
  const int type = model.geom_type[geom];
  if ((type != mjGEOM_BOX && type != mjGEOM_CYLINDER) || !is_upright(model.geom_quat + 4 * geom) ||
      !is_upright(model.body_quat + 4 * body)) {
    throw ConfigurationError(
        Location{names.path()},
        with_code(Code::world,
                  "obstacle '{}' has a geom that is not an upright box or cylinder; write "
                  "type=\"box\" or type=\"cylinder\" and turn it about z only",
                  names.body(body)));
  }
  return type == mjGEOM_BOX ? std::hypot(size[0], size[1]) : size[0];
}

std::vector<ObstacleBody> find_obstacles(const mjModel& model, const Names& names) {
  std::vector<ObstacleBody> found;
  for (int body = 1; body < model.nbody; ++body) {
    if (!names.body(body).starts_with("obstacle_") || model.body_geomnum[body] == 0) continue;
    ObstacleBody obstacle;
    obstacle.id = body;
    obstacle.mocap = model.body_mocapid[body];
    if (model.body_parentid[body] != 0 || model.body_dofnum[body] != 0) {
      throw ConfigurationError(
          Location{names.path()},
          with_code(Code::world,
                    "obstacle '{}' can move; make it a child of <worldbody> without joints",
                    names.body(body)));
    }
    const mjtNum* at = model.body_pos + 3 * body;
    obstacle.circle = {at[0], at[1], 0, heading_of(model.body_quat + 4 * body)};
    for (int i = 0; i < model.body_geomnum[body]; ++i) {
      const int geom = model.body_geomadr[body] + i;
      const mjtNum* offset = model.geom_pos + 3 * geom;
      obstacle.circle.radius =
          std::max(obstacle.circle.radius,
                   std::hypot(offset[0], offset[1]) + footprint_radius(model, geom, names));
    }
    found.push_back(obstacle);
  }
  return found;
}

bool far_enough(const Circle& circle, const std::vector<Circle>& others, const Arena& arena,
                double passage) {
  const double edge = circle.radius + passage;
  if (circle.x - edge < arena.min_x_m || circle.x + edge > arena.max_x_m ||
      circle.y - edge < arena.min_y_m || circle.y + edge > arena.max_y_m) {
    return false;
  }
  return std::all_of(others.begin(), others.end(), [&](const Circle& other) {
    return std::hypot(circle.x - other.x, circle.y - other.y) >= edge + other.radius;
  });
}

// Draws in a fixed order, so that a layout is a function of the seed alone.
class Draws {
 public:
  Draws(std::uint64_t seed, std::uint64_t purpose) : stream_(seed, kStream, purpose) {}
  double between(double low, double high) {
    return low + (high - low) * stream_.uniform(0, next_++);
  }

 private:
  RandomStream stream_;
  std::uint64_t next_ = 0;
};

bool place_one(Circle& circle, const std::vector<Circle>& others, const Arena& arena,
               double passage, Draws& draws, std::size_t& comparisons) {
  const double edge = circle.radius + passage;
  for (int i = 0; i < kTriesPerObstacle; ++i) {
    circle.x = draws.between(arena.min_x_m + edge, arena.max_x_m - edge);
    circle.y = draws.between(arena.min_y_m + edge, arena.max_y_m - edge);
    circle.heading = draws.between(-std::numbers::pi, std::numbers::pi);
    comparisons += others.size();
    if (far_enough(circle, others, arena, passage)) return true;
  }
  return false;
}

// Fills in place and heading of the mocap obstacles; starts again when the last ones do not fit.
void place(std::vector<ObstacleBody>& obstacles, const Arena& arena, double passage,
           std::uint64_t seed, const Names& names) {
  Draws draws(seed, kObstacles);
  std::size_t comparisons = 0;
  for (int layout = 0; layout < kLayouts && comparisons < kComparisons; ++layout) {
    std::vector<Circle> standing;
    for (const auto& obstacle : obstacles) {
      if (obstacle.mocap < 0) standing.push_back(obstacle.circle);
    }
    const bool complete = std::all_of(obstacles.begin(), obstacles.end(), [&](ObstacleBody& body) {
      if (body.mocap < 0) return true;
      if (!place_one(body.circle, standing, arena, passage, draws, comparisons)) return false;
      standing.push_back(body.circle);
      return true;
    });
    if (complete) return;
  }
  throw ConfigurationError(
      Location{names.path()},
      with_code(Code::world,
                "its {} obstacles do not fit into the arena with {} m between them (seed {}); "
                "write fewer or smaller obstacles, a larger arena or a smaller numeric 'passage'",
                obstacles.size(), passage, seed));
}

// Of a mocap body; at the height that the file says.
void move(int body, const Pose& pose, const mjModel& model, mjData& data) {
  const int mocap = model.body_mocapid[body];
  mjtNum* at = data.mocap_pos + 3 * mocap;
  at[0] = pose.x_m;
  at[1] = pose.y_m;
  at[2] = model.body_pos[3 * body + 2];
  mjtNum* turn = data.mocap_quat + 4 * mocap;
  turn[0] = std::cos(pose.theta_rad / 2);
  turn[1] = turn[2] = 0;
  turn[3] = std::sin(pose.theta_rad / 2);
}

void append_footprints(const ObstacleBody& body, const mjModel& model, const Names& names,
                       std::vector<Obstacle>& footprints) {
  for (int i = 0; i < model.body_geomnum[body.id]; ++i) {
    const int geom = model.body_geomadr[body.id] + i;
    const mjtNum* offset = model.geom_pos + 3 * geom;
    const mjtNum* size = model.geom_size + 3 * geom;
    const double c = std::cos(body.circle.heading);
    const double s = std::sin(body.circle.heading);
    Obstacle footprint;
    footprint.name = names.body(body.id);
    footprint.x_m = body.circle.x + c * offset[0] - s * offset[1];
    footprint.y_m = body.circle.y + s * offset[0] + c * offset[1];
    footprint.theta_rad = body.circle.heading + heading_of(model.geom_quat + 4 * geom);
    footprint.height_m = model.body_pos[3 * body.id + 2] + offset[2];  // of its middle
    if (model.geom_type[geom] == mjGEOM_BOX) {
      footprint.shape = Obstacle::Shape::box;
      footprint.half_x_m = size[0];
      footprint.half_y_m = size[1];
      footprint.height_m += size[2];
    } else {
      footprint.shape = Obstacle::Shape::cylinder;
      footprint.radius_m = size[0];
      footprint.height_m += size[1];
    }
    footprints.push_back(footprint);
  }
}

Pose draw_anywhere(const Arena& arena, Draws& draws) {
  Pose pose;
  pose.x_m = draws.between(arena.min_x_m, arena.max_x_m);
  pose.y_m = draws.between(arena.min_y_m, arena.max_y_m);
  pose.theta_rad = draws.between(-std::numbers::pi, std::numbers::pi);
  return pose;
}

// On a centre line, in one of its two directions.
Pose draw_on_lane(const std::vector<Obstacle>& lanes, Draws& draws) {
  const double half_length = std::accumulate(
      lanes.begin(), lanes.end(), 0.0,
      [](double sum, const Obstacle& lane) { return sum + CentreLine(lane).half_length_m; });
  double along = draws.between(0, 2 * half_length);
  auto lane = lanes.begin();
  while (along > 2 * CentreLine(*lane).half_length_m && lane + 1 != lanes.end()) {
    along -= 2 * CentreLine(*lane++).half_length_m;
  }
  const CentreLine line(*lane);
  Pose pose = line.at(along - line.half_length_m);
  if (draws.between(-1, 1) < 0) pose.theta_rad += std::numbers::pi;
  return pose;
}

// Whether the lane goes on for this way, ahead and behind.
bool far_from_ends(const std::vector<Obstacle>& lanes, const Pose& pose, double way) {
  return std::ranges::all_of(std::array{-way, way}, [&](double ahead) {
    const Pose there{pose.x_m + ahead * std::cos(pose.theta_rad),
                     pose.y_m + ahead * std::sin(pose.theta_rad), pose.theta_rad};
    return find_lane_position(lanes, there)->is_inside();
  });
}

Pose draw_start(const Arena& arena, const std::vector<Obstacle>& obstacles,
                const std::vector<Obstacle>& lanes, double clearance, std::uint64_t seed,
                const Names& names) {
  Draws draws(seed, kStart);
  for (int i = 0; i < kTriesForStart; ++i) {
    const Pose pose = lanes.empty() ? draw_anywhere(arena, draws) : draw_on_lane(lanes, draws);
    if (clearance_m(arena, obstacles, pose.x_m, pose.y_m) >= clearance &&
        (lanes.empty() || far_from_ends(lanes, pose, clearance))) {
      return pose;
    }
  }
  throw ConfigurationError(
      Location{names.path()},
      with_code(
          Code::world,
          "has no place that is {} m away from every wall, obstacle and end of a lane (seed {}); "
          "write a smaller numeric 'start_clearance' or fewer obstacles",
          clearance, seed));
}

Pose start_pose(const Arena& arena, const std::vector<Obstacle>& obstacles,
                const std::vector<Obstacle>& lanes, const Parts& parts, std::uint64_t seed,
                const Names& names) {
  if (const auto fixed = names.numeric("start", 3, "x, y (m) and heading (rad)")) {
    const Pose pose{(*fixed)[0], (*fixed)[1], (*fixed)[2]};
    if (clearance_m(arena, obstacles, pose.x_m, pose.y_m) < parts.radius_m) {
      throw ConfigurationError(
          names.where("start"),
          with_code(Code::world,
                    "numeric 'start' = ({}, {}) is nearer than the vehicle's radius of {:.3f} m "
                    "to a wall or an obstacle; write a free place",
                    pose.x_m, pose.y_m, parts.radius_m));
    }
    return pose;
  }
  const double clearance =
      names.number("start_clearance", 0.45, "metres from the vehicle's centre to the next thing");
  return draw_start(arena, obstacles, lanes, std::max(clearance, parts.radius_m), seed, names);
}

}  // namespace

Arena read_arena(const Names& names) {
  constexpr std::string_view kMeaning =
      "smallest x and y, largest x and y of the walls' inner faces";
  const auto values = names.required_numeric("arena", 4, kMeaning);
  if (!(values[0] < values[2] && values[1] < values[3])) {
    throw ConfigurationError(
        names.where("arena"),
        with_code(Code::world, "numeric 'arena' is \"{}\", which is empty; write {}",
                  fmt::join(values, " "), kMeaning));
  }
  const double longest = std::max(values[2] - values[0], values[3] - values[1]);
  if (longest > kLongestSide) {
    throw ConfigurationError(
        names.where("arena"),
        with_code(Code::world, "numeric 'arena' has a side of {} m; write at most {} m from {}",
                  longest, kLongestSide, kMeaning));
  }
  return {values[0], values[1], values[2], values[3]};
}

double clearance_m(const Arena& arena, const std::vector<Obstacle>& obstacles, double x, double y) {
  double nearest =
      std::min({x - arena.min_x_m, arena.max_x_m - x, y - arena.min_y_m, arena.max_y_m - y});
  for (const auto& obstacle : obstacles) nearest = std::min(nearest, obstacle.distance_m(x, y));
  return nearest;
}

std::vector<Obstacle> place_obstacles(const mjModel& model, mjData& data, const Names& names,
                                      const Arena& arena, std::uint64_t seed) {
  auto bodies = find_obstacles(model, names);
  const double passage = names.number("passage", 0.9, "metres between obstacles");
  place(bodies, arena, passage, seed, names);
  std::vector<Obstacle> footprints;
  for (const auto& body : bodies) {
    if (body.mocap >= 0) {
      move(body.id, {body.circle.x, body.circle.y, body.circle.heading}, model, data);
    }
    append_footprints(body, model, names, footprints);
  }
  return footprints;
}

void place_vehicle(mjData& data, const Names& names, const Parts& parts, const Arena& arena,
                   const std::vector<Obstacle>& obstacles, const std::vector<Obstacle>& lanes,
                   std::uint64_t seed) {
  const Pose start = start_pose(arena, obstacles, lanes, parts, seed, names);
  mjtNum* position = data.qpos + parts.qpos;
  position[0] = start.x_m;
  position[1] = start.y_m;
  position[3] = std::cos(start.theta_rad / 2);
  position[4] = position[5] = 0;
  position[6] = std::sin(start.theta_rad / 2);
}

int place_cue(const mjModel& model, mjData& data, const Names& names, std::uint64_t seed) {
  const int cue = mj_name2id(&model, mjOBJ_BODY, "cue");
  if (cue < 0) return 0;
  std::vector<Pose> places;
  while (const auto place = names.numeric(fmt::format("cue_place_{}", places.size() + 1), 3,
                                          "x, y (m) and heading (rad)")) {
    places.push_back({(*place)[0], (*place)[1], (*place)[2]});
  }
  if (places.empty() || model.body_mocapid[cue] < 0) {
    throw ConfigurationError(Location{names.path()},
                             with_code(Code::world,
                                       "body 'cue' is put in one of several places by the seed; "
                                       "write mocap=\"true\" in it, and "
                                       "<custom><numeric name=\"cue_place_1\" data=\"X Y "
                                       "HEADING\"/></custom>, cue_place_2 and so "
                                       "on"));
  }
  const double drawn = Draws(seed, kCue).between(0, static_cast<double>(places.size()));
  const auto chosen = static_cast<std::size_t>(drawn);
  move(cue, places[chosen], model, data);
  return static_cast<int>(chosen) + 1;
}

double Obstacle::distance_m(double x, double y) const {
  const double dx = x - x_m;
  const double dy = y - y_m;
  if (shape == Shape::cylinder) return std::max(0.0, std::hypot(dx, dy) - radius_m);
  const double c = std::cos(theta_rad);
  const double s = std::sin(theta_rad);
  const double outside_x = std::max(0.0, std::abs(c * dx + s * dy) - half_x_m);
  const double outside_y = std::max(0.0, std::abs(c * dy - s * dx) - half_y_m);
  return std::hypot(outside_x, outside_y);
}

}  // namespace spikeloop::vehicle
