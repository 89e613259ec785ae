// A session of any kind, and a robot at the other end of its topics: in ROS 1 with roscpp's own
// messages, in ROS 2 another node of ours (tests/ros2 has other vendors).
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "spikeloop/topics/session.hpp"

namespace spikeloop::test {

class Meeting {
 public:
  Meeting() = default;
  virtual ~Meeting() = default;
  Meeting(const Meeting&) = delete;
  Meeting& operator=(const Meeting&) = delete;

  virtual topics::Session& session() = 0;

  virtual void publish_scan(const std::string& topic, const std::vector<float>& ranges,
                            float range_min, float range_max) = 0;
  virtual void publish_twist(const std::string& topic, double linear_x, double angular_z) = 0;
  virtual void publish_array(const std::string& topic, const std::vector<double>& data) = 0;
  virtual void publish_odometry(const std::string& topic, double x, double y, double z) = 0;

  virtual void listen_twist(const std::string& topic) = 0;
  virtual void listen_array(const std::string& topic) = 0;
  /// linear.x and angular.z of those that have come.
  virtual std::vector<std::array<double, 2>> twists() const = 0;
  virtual std::vector<std::vector<double>> arrays() const = 0;
};

enum class Kind : std::uint8_t { memory, ros1, ros2 };
std::unique_ptr<Meeting> meet(Kind kind);
inline void PrintTo(Kind kind, std::ostream* out) {
  *out << (kind == Kind::memory ? "in memory" : kind == Kind::ros1 ? "ROS 1" : "ROS 2");
}
inline auto kinds() {
  return testing::Values(Kind::memory, Kind::ros1, Kind::ros2);
}

}  // namespace spikeloop::test
