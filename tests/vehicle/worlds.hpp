// Worlds the tests write for themselves.
#pragma once

#include <numbers>
#include <string>

#include "spikeloop/vehicle/vehicle.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::vehicle {

inline constexpr TimeNs kMs = 1'000'000;
inline constexpr TimeNs kSecond = kNsPerSecond;

/// Half the side of the test worlds' square arena.
inline constexpr double kHalf = 3.0;

inline const std::string kFloor = R"(<geom name="floor" type="plane" size="9 9 0.1"/>)";
inline const std::string kWalls = R"(
  <geom name="wall_east"  type="box" size="0.05 3.1 0.25" pos=" 3.05 0 0.25"/>
  <geom name="wall_west"  type="box" size="0.05 3.1 0.25" pos="-3.05 0 0.25"/>
  <geom name="wall_north" type="box" size="3.1 0.05 0.25" pos="0  3.05 0.25"/>
  <geom name="wall_south" type="box" size="3.1 0.05 0.25" pos="0 -3.05 0.25"/>)";
inline const std::string kArena = R"(<numeric name="arena" data="-3 -3 3 3"/>)";
inline const std::string kStart = R"(<numeric name="start" data="0 0 0"/>)";

/// MJCF with the shipped vehicle: `numerics` go into <custom>, `bodies` into <worldbody>.
inline std::string mjcf(const std::string& numerics, const std::string& bodies) {
  return R"(<mujoco><size njmax="200" nconmax="50"/><include file="spikeloop_vehicle.xml"/>
<custom>)" +
         numerics + "</custom>\n<worldbody>" + bodies + "</worldbody>\n</mujoco>\n";
}

/// A world of a test's own that lives as long as this object.
class World {
 public:
  explicit World(const std::string& text) : path_(directory_.write("world.xml", text)) {}
  World(const std::string& numerics, const std::string& bodies) : World(mjcf(numerics, bodies)) {}
  const std::string& path() const { return path_; }
  Vehicle vehicle(std::uint64_t seed = 1) const { return Vehicle({path_, seed}); }

 private:
  test::TemporaryDirectory directory_;
  std::string path_;
};

/// The difference of two headings, in (-pi, pi].
inline double turned(double from, double to) {
  double difference = to - from;
  while (difference > std::numbers::pi) difference -= 2 * std::numbers::pi;
  while (difference <= -std::numbers::pi) difference += 2 * std::numbers::pi;
  return difference;
}

}  // namespace spikeloop::vehicle
