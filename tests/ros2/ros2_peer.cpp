// The robot of fastdds_peer.cpp on a node of ours, or the brain that it needs: another process for
// the tests.
//
//     ros2_peer DOMAIN [brain]
//
// The robot publishes scans on /scan twenty times a second, and says which twists come on /cmd_vel;
// the brain publishes twists, and says that scans come. The environment says where they look.
#include <fmt/format.h>
#include <signal.h>

#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>
#include <vector>

#include "spikeloop/core/log.hpp"
#include "spikeloop/discovery/discovery.hpp"
#include "spikeloop/ros2/session.hpp"

namespace {

using namespace spikeloop;

double value_at(std::span<const std::byte> message, std::size_t place) {
  double value = 0;
  std::memcpy(&value, message.data() + 4 + place, sizeof value);
  return value;
}

void say(const std::string& text) {
  fmt::print("{}\n", text);
  std::fflush(stdout);
}

void say_twist(std::span<const std::byte> message) {
  say(fmt::format("twist {:g} {:g}", value_at(message, 0), value_at(message, 40)));
}

void say_scan(std::span<const std::byte> /*message*/) {
  say("scan");
}

/// What stands before the fields: XCDR1, little endian.
std::vector<std::byte> message_of(std::size_t field_bytes) {
  std::vector<std::byte> message(4 + field_bytes);
  message[1] = std::byte{1};
  return message;
}

/// No frame, no ranges.
std::vector<std::byte> empty_scan() {
  std::vector<std::byte> message = message_of(8 + 4 + 4 + 28 + 4 + 4);
  message[12] = std::byte{1};  // the frame's NUL
  return message;
}

std::vector<std::byte> zero_twist() {
  return message_of(48);
}

struct Topic {
  const char* name;
  const char* type;
};
constexpr Topic kScan{"/scan", "sensor_msgs/LaserScan"};
constexpr Topic kCommand{"/cmd_vel", "geometry_msgs/Twist"};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "write ros2_peer DOMAIN [brain]\n");
    return 2;
  }
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  log::set_sink([](log::Level, std::string_view text) { say(fmt::format("log: {}", text)); });
  const bool brain = argc > 2 && std::string_view(argv[2]) == "brain";
  topics::Place place = discovery::environment();
  place["ROS_DOMAIN_ID"] = argv[1];
  ros2::Session session({.node_name = brain ? "brain" : "robot", .place = place});
  const Topic out = brain ? kCommand : kScan;
  const Topic in = brain ? kScan : kCommand;
  const auto publisher = session.publisher(out.name, out.type);
  const auto subscriber = session.subscriber(
      {.topic = in.name, .message_type = in.type, .take = brain ? say_scan : say_twist});
  say("ready");
  const timespec tick{0, 50'000'000};
  while (sigtimedwait(&signals, nullptr, &tick) < 0) {
    publisher->publish(brain ? zero_twist() : empty_scan());
  }
  return 0;
}
