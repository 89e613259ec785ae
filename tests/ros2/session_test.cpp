// How a session joins a domain, and what it says if it cannot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <mutex>
#include <string>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/processes/descriptor.hpp"
#include "spikeloop/ros2/session.hpp"
#include "tests/ros2/domain.hpp"
#include "tests/ros2/heard.hpp"
#include "tests/support/error_of.hpp"

namespace {

using namespace spikeloop;
using ros2::Session;
using test::eventually;
using test::Heard;
using test::message_of;
using test::pattern;

constexpr double kPatience = 20;  // seconds

TEST(Ros2Session, says_what_cyclone_dds_refuses) {
  const test::FreeDomain domain;
  topics::Place place = domain.place();
  place["CYCLONEDDS_URI"] = "<CycloneDDS><Domain><Nonsense/></Domain></CycloneDDS>";
  try {
    const Session session({.node_name = "brain", .place = place});
    FAIL() << "no error";
  } catch (const TransportError& error) {
    EXPECT_THAT(error.what(),
                testing::HasSubstr("Cyclone DDS makes no domain in domain " + domain.text()));
    EXPECT_THAT(error.what(), testing::HasSubstr("Nonsense: unknown element"));
    EXPECT_THAT(error.what(), testing::HasSubstr("look at CYCLONEDDS_URI"));
  }
  // And the next one starts.
  EXPECT_EQ(Session({.node_name = "brain", .place = domain.place()}).node_name(), "/brain");
}

TEST(Ros2Session, warns_of_a_peer_without_an_address) {
  const test::FreeDomain domain;
  std::vector<std::string> said;
  std::mutex mutex;
  log::set_sink([&](log::Level, std::string_view message) {
    const std::lock_guard lock(mutex);
    said.emplace_back(message);
  });
  {
    const Session session({.node_name = "brain",
                           .place = {{"ROS_DOMAIN_ID", domain.text()},
                                     {"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"},
                                     {"ROS_STATIC_PEERS", "no-such-robot.invalid;127.0.0.1"}}});
  }
  log::set_sink({});
  EXPECT_THAT(said,
              testing::Contains(testing::HasSubstr("no-such-robot.invalid: unknown address")));
  EXPECT_THAT(said, testing::Not(testing::Contains(testing::HasSubstr("127.0.0.1"))));
}

TEST(Ros2Session, takes_interfaces_from_cyclonedds_uri) {
  const test::FreeDomain domain;
  topics::Place place = domain.place();
  place["CYCLONEDDS_URI"] =
      "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/>"
      "</Interfaces></General></Domain></CycloneDDS>";
  Heard heard;
  Session robot({.node_name = "robot", .place = place});
  Session brain({.node_name = "brain", .place = domain.place()});
  const auto publisher = robot.publisher("/in", "std_msgs/String");
  const auto subscriber = brain.subscriber(heard.subscription("/in", "std_msgs/String", 1));
  EXPECT_TRUE(eventually(kPatience, [&] {
    publisher->publish(message_of(pattern(8)));
    return heard.count() > 0;
  }));
}

/// Occupies a UDP port. Another program may have it already, with the same effect.
Descriptor take_port(int port) {
  Descriptor socket{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
  return socket;
}

/// The rmw layers have 33 participants on a machine, and take the first of these ports.
TEST(Ros2Session, meets_others_beyond_the_ports_that_rmw_tries) {
  const test::FreeDomain domain;
  std::vector<Descriptor> taken;
  for (int index = 0; index < 40; ++index) {
    taken.push_back(take_port(7410 + 250 * domain.number() + 2 * index));
  }
  Heard heard;
  Session robot({.node_name = "robot", .place = domain.place()});
  Session brain({.node_name = "brain", .place = domain.place()});
  const auto publisher = robot.publisher("/in", "std_msgs/String");
  const auto subscriber = brain.subscriber(heard.subscription("/in", "std_msgs/String", 1));
  EXPECT_TRUE(eventually(kPatience, [&] {
    publisher->publish(message_of(pattern(8)));
    return heard.count() > 0;
  }));
}

TEST(Ros2Session, names_the_limit_of_a_full_domain) {
  topics::Place place{{"ROS_DOMAIN_ID", "232"}, {"ROS_LOCALHOST_ONLY", "1"}};
  std::vector<Descriptor> taken;
  for (int port = 65'410; port <= 65'535; port += 2) {
    taken.push_back(take_port(port));
  }
  EXPECT_EQ(
      test::error_of<TransportError>([&] { Session({.node_name = "brain", .place = place}); }),
      "domain 232 of ROS 2 has reached its limit of 63 participants on this machine; end "
      "other programs of the domain, or set another ROS_DOMAIN_ID [SL0604]");
}

TEST(Ros2Session, goes_into_the_highest_domain) {
  const Session session(
      {.node_name = "brain", .place = {{"ROS_DOMAIN_ID", "232"}, {"ROS_LOCALHOST_ONLY", "1"}}});
  EXPECT_EQ(session.place().at("ROS_DOMAIN_ID"), "232");
}

TEST(Ros2Session, has_a_place_where_another_one_meets_it) {
  const test::FreeDomain domain;
  const Session robot(
      {.node_name = "robot", .arguments = {{"__ns", "/arena"}}, .place = domain.place()});
  EXPECT_EQ(robot.node_name(), "/arena/robot");
  EXPECT_EQ(robot.place(), domain.place());
  EXPECT_EQ(robot.whole_topic("scan"), "/arena/scan");
  EXPECT_TRUE(robot.alive());
}

}  // namespace
