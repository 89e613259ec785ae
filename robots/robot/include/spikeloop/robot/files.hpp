// What a run leaves on disk: the path driven, the world it was driven in, the result.
#pragma once

#include <cstdio>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "spikeloop/core/write_failures.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::robot {

/// A text file with a row per event. A failed write ends the file and is added to `failures`. If
/// `failures` is null, it throws FileError.
class RowFile {
 public:
  /// Replaces a file of the same name. @throws FileError.
  RowFile(std::string path, const std::string& head, WriteFailures* failures);
  void write(const std::string& row);
  void flush();
  void close();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  template <typename Work>
  void attempt(Work&& work);

  std::string path_;
  WriteFailures* failures_;
  std::unique_ptr<std::FILE, Close> file_;  // null after close(), or a failure
};

/// trajectory.csv: t_s, x_m, y_m, theta_rad, v_m_s, w_rad_s, collisions (counted so far;
/// nan: not known).
class TrajectoryFile {
 public:
  /// Makes the directory when there is none. @throws FileError.
  explicit TrajectoryFile(const std::string& directory, WriteFailures* failures = nullptr);
  /// Can be read from the file within 50 ms, when rows go on to come. @throws FileError, as
  /// RowFile.
  void write(const vehicle::Odometry& odometry, std::optional<std::uint64_t> collisions);
  /// @throws FileError, as RowFile.
  void close() { file_.close(); }

 private:
  RowFile file_;
  TimeNs flushed_ = 0;  ///< wall time
};

/// world.json: file, seed, arena, obstacles, start pose and size of the vehicle, in metres; where
/// a cue stands. Heights are those of tops above z = 0, the floor.
/// @throws FileError.
void write_world(const std::string& directory, const vehicle::Vehicle& vehicle, std::uint64_t seed);

/// What a summary says of a drive: collisions, distance_m, coverage, mean_speed_m_s; nothing of a
/// robot that is not the vehicle.
nlohmann::json summary_of(const vehicle::Simulation& robot);

}  // namespace spikeloop::robot
