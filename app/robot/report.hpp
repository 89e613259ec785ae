// What spikeloop-robot reports of a run.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::robot {

inline nlohmann::json counters_of(const vehicle::Simulation& robot, std::uint64_t commands,
                                  std::uint64_t scans) {
  nlohmann::json counters{{"commands", commands}};
  if (robot.vehicle() != nullptr) {
    const vehicle::Statistics statistics = robot.vehicle()->statistics();
    counters["invalid_commands"] = statistics.invalid_commands;
    counters["clamped_commands"] = statistics.clamped_commands;
    counters["scans"] = scans;
  }
  return counters;
}

/// "collisions 0, distance 1.25 m, mean speed 0.125 m/s, coverage 3.0 %, "; empty for a robot that
/// is not the vehicle.
inline std::string drive_text(const vehicle::Simulation& robot) {
  if (robot.vehicle() == nullptr) return {};
  const vehicle::Statistics drive = robot.vehicle()->statistics();
  return fmt::format("collisions {}, distance {:.2f} m, mean speed {:.3f} m/s, coverage {:.1f} %, ",
                     drive.collisions, drive.distance_m, drive.mean_speed_m_s,
                     100 * drive.coverage);
}

}  // namespace spikeloop::robot
