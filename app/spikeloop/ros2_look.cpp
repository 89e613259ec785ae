#include "ros2_look.hpp"

#include <chrono>
#include <thread>

#include "spikeloop/ros2/session.hpp"

namespace spikeloop::app {
namespace {

constexpr std::chrono::milliseconds kPatience{1500};
constexpr std::chrono::milliseconds kPeriod{10};

}  // namespace

bool published_in_ros2(const std::string& topic) {
  ros2::Session session({.node_name = "spikeloop_look", .unique_name = true});
  const auto scans = session.subscriber({.topic = topic,
                                         .message_type = "sensor_msgs/LaserScan",
                                         .take = [](std::span<const std::byte>) {}});
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!scans->has_publishers() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(kPeriod);
  }
  return scans->has_publishers();
}

}  // namespace spikeloop::app
