// The path and the collisions of a robot that is not ours, as its topics tell them.
#pragma once

#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "contact_counter.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/robot/files.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop {

/// Writes trajectory.csv of what comes on /odom (nav_msgs/Odometry); without a message there is no
/// file. Collisions are those of ContactCounter; nan: not known.
class OdometryLog {
 public:
  /// @param failures receives failed writes of the file
  OdometryLog(topics::Session& session, std::string folder, WriteFailures& failures);

  /// A row, every 20 ms at most, when a message has come since the last one. @throws FileError.
  void tick(TimeNs time);
  /// @throws FileError.
  void close();
  /// distance_m, mean_speed_m_s and visited_m2 (of squares 0.5 m wide) of the rows, when there are
  /// any; collisions, when they are known.
  nlohmann::json summary() const;

 private:
  void take(std::span<const std::byte> message);
  void write(const vehicle::Odometry& now);

  std::string folder_;
  WriteFailures& failures_;
  ContactCounter contacts_;
  std::vector<messages::FieldReader> fields_;
  std::optional<robot::TrajectoryFile> file_;
  std::optional<vehicle::Odometry> first_;
  vehicle::Odometry last_;  ///< that was written
  double distance_m_ = 0;
  std::set<std::pair<long, long>> visited_{};  ///< squares
  std::mutex mutex_;
  std::optional<vehicle::Odometry> newest_;            ///< and not written yet
  std::unique_ptr<topics::RawSubscriber> subscriber_;  ///< last: its callback uses the others
};

}  // namespace spikeloop
