// What the environment says of where a node looks for others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/core/error.hpp"
#include "spikeloop/ros2/discovery.hpp"
#include "spikeloop/ros2/session.hpp"
#include "tests/ros2/domain.hpp"

namespace {

using namespace spikeloop;
using namespace spikeloop::ros2;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::string error_of(const Variables& variables) {
  try {
    discovery(variables);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "no error";
}

const Interfaces kNetwork{.loopback = "lo", .addresses = {"192.0.2.2"}};

TEST(Ros2Discovery, is_that_of_ros_2_by_default) {
  const Discovery found = discovery({});
  EXPECT_EQ(found.domain, 0U);
  EXPECT_EQ(found.range, Range::subnet);
  EXPECT_THAT(found.peers, IsEmpty());
  // Set, but empty, is not set.
  EXPECT_EQ(discovery({{"ROS_DOMAIN_ID", ""}, {"ROS_LOCALHOST_ONLY", ""}}).range, Range::subnet);
}

TEST(Ros2Discovery, reads_the_variables) {
  const Discovery found = discovery({{"ROS_DOMAIN_ID", "232"},
                                     {"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"},
                                     {"ROS_STATIC_PEERS", "robot.local;192.0.2.7;"},
                                     {"CYCLONEDDS_URI", "file:///etc/cyclone.xml"},
                                     {"ROS_DISTRO", "jazzy"}});
  EXPECT_EQ(found.domain, 232U);
  EXPECT_EQ(found.range, Range::localhost);
  EXPECT_THAT(found.peers, ElementsAre("robot.local", "192.0.2.7"));
  EXPECT_EQ(found.cyclone, "file:///etc/cyclone.xml");
  EXPECT_EQ(found.distribution, "jazzy");
  EXPECT_EQ(discovery({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"}}).range, Range::subnet);
  EXPECT_EQ(discovery({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT"}}).range,
            Range::system_default);
}

TEST(Ros2Discovery, static_peers_are_tried_after_this_machine) {
  for (const char* range : {"SUBNET", "LOCALHOST"}) {
    const Discovery found =
        discovery({{"ROS_AUTOMATIC_DISCOVERY_RANGE", range}, {"ROS_STATIC_PEERS", "192.0.2.7"}});
    EXPECT_THAT(cyclone_settings(found, kNetwork, 0),
                HasSubstr("<Peer address=\"192.0.2.2\"/><Peer address=\"192.0.2.7\"/></Peers>"));
  }
}

TEST(Ros2Discovery, localhost_only_wins) {
  const Discovery found = discovery({{"ROS_LOCALHOST_ONLY", "1"},
                                     {"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"},
                                     {"ROS_STATIC_PEERS", "192.0.2.7"}});
  EXPECT_EQ(found.range, Range::localhost);
  EXPECT_THAT(found.peers, IsEmpty());
  EXPECT_EQ(discovery({{"ROS_LOCALHOST_ONLY", "0"}}).range, Range::subnet);
}

TEST(Ros2Discovery, who_is_off_has_no_peers) {
  const Discovery found =
      discovery({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"}, {"ROS_STATIC_PEERS", "192.0.2.7"}});
  EXPECT_EQ(found.range, Range::off);
  EXPECT_THAT(found.peers, IsEmpty());
}

TEST(Ros2Discovery, says_what_is_wrong) {
  for (const char* wrong : {"abc", "233", "-1", "1.5", " 1", "99999999999"}) {
    EXPECT_EQ(error_of({{"ROS_DOMAIN_ID", wrong}}),
              "ROS_DOMAIN_ID is '" + std::string(wrong) +
                  "', which is no domain of ROS 2; write a whole number from 0 to 232");
  }
  EXPECT_EQ(error_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "subnet"}}),
            "ROS_AUTOMATIC_DISCOVERY_RANGE is 'subnet'; write SUBNET, LOCALHOST, OFF or "
            "SYSTEM_DEFAULT");
  EXPECT_EQ(error_of({{"ROS_LOCALHOST_ONLY", "yes"}}),
            "ROS_LOCALHOST_ONLY is 'yes'; write 1 for this machine alone, or 0");
  EXPECT_EQ(error_of({{"ROS_STATIC_PEERS", "192.0.2.7, 192.0.2.8"}}),
            "ROS_STATIC_PEERS has '192.0.2.7, 192.0.2.8', which is no address; write host names or "
            "IP addresses with ';' between them");
}

TEST(Ros2Discovery, settings_multicast_beyond_this_machine_in_the_subnet_alone) {
  const std::string subnet = cyclone_settings(discovery({}), kNetwork, 0);
  EXPECT_THAT(subnet, HasSubstr("<AllowMulticast>spdp</AllowMulticast>"));
  EXPECT_THAT(subnet, HasSubstr("autodetermine=\"true\""));
  EXPECT_THAT(subnet, HasSubstr("<Peer address=\"127.0.0.1\"/><Peer address=\"192.0.2.2\"/>"));
  const std::string here = cyclone_settings(discovery({{"ROS_LOCALHOST_ONLY", "1"}}), kNetwork, 0);
  EXPECT_THAT(here, HasSubstr("<AllowMulticast>false</AllowMulticast>"));
  const std::string own = cyclone_settings(
      discovery({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT"}}), kNetwork, 0);
  EXPECT_THAT(own, Not(HasSubstr("AllowMulticast")));
  EXPECT_THAT(own, Not(HasSubstr("Peer")));
}

TEST(Ros2Discovery, a_machine_without_a_network_has_its_loopback_interface) {
  const std::string settings = cyclone_settings(discovery({}), {}, 0);
  EXPECT_THAT(settings, Not(HasSubstr("autodetermine")));
  EXPECT_THAT(settings, HasSubstr("<NetworkInterface name=\"lo\" multicast=\"true\"/>"));
  EXPECT_THAT(settings, HasSubstr("<Peers><Peer address=\"127.0.0.1\"/></Peers>"));
}

TEST(Ros2Discovery, cyclonedds_uri_has_the_last_word) {
  EXPECT_THAT(cyclone_settings(discovery({{"CYCLONEDDS_URI", "<Tracing/>"}}), kNetwork, 0),
              testing::EndsWith("</CycloneDDS>,<Tracing/>"));
}

TEST(Ros2Discovery, this_machine_has_a_loopback_interface) {
  EXPECT_EQ(interfaces().loopback, "lo");
}

TEST(Ros2Discovery, what_cyclone_dds_refuses_is_in_the_error) {
  const test::FreeDomain domain;
  topics::Place place = domain.place();
  place["CYCLONEDDS_URI"] = "<CycloneDDS><Domain><Nonsense/></Domain></CycloneDDS>";
  try {
    const Session session({.node_name = "brain", .place = place});
    FAIL() << "no error";
  } catch (const TransportError& error) {
    EXPECT_THAT(error.what(), HasSubstr("Cyclone DDS makes no domain in domain " + domain.text()));
    EXPECT_THAT(error.what(), HasSubstr("Nonsense: unknown element"));
    EXPECT_THAT(error.what(), HasSubstr("look at CYCLONEDDS_URI"));
  }
  // And the next one starts.
  EXPECT_EQ(Session({.node_name = "brain", .place = domain.place()}).node_name(), "/brain");
}

}  // namespace
