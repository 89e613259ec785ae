// The robot of fastdds_peer.cpp on a node of ours: another process for the tests.
//
//     ros2_peer DOMAIN [anything]
#include <fmt/format.h>
#include <signal.h>

#include <cstdio>
#include <cstring>
#include <vector>

#include "spikeloop/ros2/session.hpp"

namespace {

using namespace spikeloop;

double value_at(std::span<const std::byte> message, std::size_t place) {
  double value = 0;
  std::memcpy(&value, message.data() + 4 + place, sizeof value);
  return value;
}

/// No frame, no ranges.
std::vector<std::byte> empty_scan() {
  std::vector<std::byte> message(4 + 8 + 4 + 4 + 28 + 4 + 4);
  message[1] = std::byte{1};
  message[12] = std::byte{1};  // the frame's NUL
  return message;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "write ros2_peer DOMAIN\n");
    return 2;
  }
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  ros2::Session session(
      {.node_name = "robot", .place = {{"ROS_DOMAIN_ID", argv[1]}, {"ROS_LOCALHOST_ONLY", "1"}}});
  const auto scans = session.publisher("/scan", "sensor_msgs/LaserScan");
  const auto twists = session.subscriber(
      {.topic = "/cmd_vel", .message_type = "geometry_msgs/Twist", .take = [](auto message) {
         fmt::print("twist {:g} {:g}\n", value_at(message, 0), value_at(message, 40));
         std::fflush(stdout);
       }});
  fmt::print("ready\n");
  std::fflush(stdout);
  const timespec tick{0, 50'000'000};
  while (sigtimedwait(&signals, nullptr, &tick) < 0) {
    scans->publish(empty_scan());
  }
  return 0;
}
