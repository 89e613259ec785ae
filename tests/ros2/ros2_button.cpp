// An emergency button on a node of ours, in a process of its own. The environment says where it
// looks for others.
//
//     ros2_button DOMAIN once|stay
#include <vector>

#include "spikeloop/discovery/discovery.hpp"
#include "spikeloop/ros2/session.hpp"
#include "tests/ros2/button.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("write ros2_button DOMAIN once|stay\n", stderr);
    return 2;
  }
  const sigset_t signals = spikeloop::test::block_button_signals();
  spikeloop::topics::Place place = spikeloop::discovery::environment();
  place["ROS_DOMAIN_ID"] = argv[1];
  spikeloop::ros2::Session session({.node_name = "button", .place = place});
  const auto publisher = session.publisher("/emergency_stop", "std_msgs/Bool");
  const std::vector<std::byte> pressed{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0},
                                       std::byte{1}};
  spikeloop::test::run_button(
      argv[2], signals, [&] { return publisher->has_subscribers(); },
      [&] { publisher->publish(pressed); });
  return 0;
}
