// What the environment says of where a node looks for others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/core/error.hpp"
#include "spikeloop/discovery/discovery.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace spikeloop;
using namespace spikeloop::discovery;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::string error_of(const Variables& variables) {
  try {
    parse(variables);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "no error";
}

const Interfaces kNetwork{.loopback = "lo", .addresses = {"192.0.2.2"}};

TEST(DiscoveryTest, is_that_of_ros_2_by_default) {
  const Discovery found = parse({});
  EXPECT_EQ(found.domain, 0U);
  EXPECT_EQ(found.range, Range::subnet);
  EXPECT_THAT(found.peers, IsEmpty());
  // Set, but empty, is not set.
  EXPECT_EQ(parse({{"ROS_DOMAIN_ID", ""}, {"ROS_LOCALHOST_ONLY", ""}}).range, Range::subnet);
}

TEST(DiscoveryTest, reads_the_variables) {
  const Discovery found = parse({{"ROS_DOMAIN_ID", "232"},
                                 {"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"},
                                 {"ROS_STATIC_PEERS", "robot.local;192.0.2.7;"},
                                 {"CYCLONEDDS_URI", "file:///etc/cyclone.xml"},
                                 {"ROS_DISTRO", "jazzy"}});
  EXPECT_EQ(found.domain, 232U);
  EXPECT_EQ(found.range, Range::localhost);
  EXPECT_THAT(found.peers, ElementsAre("robot.local", "192.0.2.7"));
  EXPECT_EQ(found.cyclone, "file:///etc/cyclone.xml");
  EXPECT_EQ(found.distribution, "jazzy");
  EXPECT_EQ(parse({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"}}).range, Range::subnet);
  EXPECT_EQ(parse({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT"}}).range,
            Range::system_default);
}

TEST(DiscoveryTest, static_peers_are_tried_after_this_machine) {
  for (const char* range : {"SUBNET", "LOCALHOST"}) {
    const Discovery found =
        parse({{"ROS_AUTOMATIC_DISCOVERY_RANGE", range}, {"ROS_STATIC_PEERS", "192.0.2.7"}});
    EXPECT_THAT(cyclone_settings(found, kNetwork, 0),
                HasSubstr("<Peer address=\"192.0.2.2\"/><Peer address=\"192.0.2.7\"/></Peers>"));
    // They are beyond the interface of the highest priority.
    EXPECT_THAT(cyclone_settings(found, kNetwork, 0),
                HasSubstr("autodetermine=\"true\" priority=\"1\"/><NetworkInterface name=\"lo\" "
                          "multicast=\"true\" priority=\"0\"/>"));
  }
}

TEST(DiscoveryTest, localhost_only_wins) {
  const Discovery found = parse({{"ROS_LOCALHOST_ONLY", "1"},
                                 {"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"},
                                 {"ROS_STATIC_PEERS", "192.0.2.7"}});
  EXPECT_EQ(found.range, Range::localhost);
  EXPECT_THAT(found.peers, IsEmpty());
  EXPECT_EQ(parse({{"ROS_LOCALHOST_ONLY", "0"}}).range, Range::subnet);
}

TEST(DiscoveryTest, who_is_off_has_no_peers) {
  const Discovery found =
      parse({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"}, {"ROS_STATIC_PEERS", "192.0.2.7"}});
  EXPECT_EQ(found.range, Range::off);
  EXPECT_THAT(found.peers, IsEmpty());
}

TEST(DiscoveryTest, says_what_is_wrong) {
  for (const char* wrong : {"abc", "233", "-1", "1.5", " 1", "99999999999"}) {
    EXPECT_EQ(error_of({{"ROS_DOMAIN_ID", wrong}}),
              "ROS_DOMAIN_ID is '" + std::string(wrong) +
                  "', which is not a domain of ROS 2; write a whole number from 0 to 232 [SL0510]");
  }
  EXPECT_EQ(error_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "subnet"}}),
            "ROS_AUTOMATIC_DISCOVERY_RANGE is 'subnet'; write SUBNET, LOCALHOST, OFF or "
            "SYSTEM_DEFAULT [SL0510]");
  EXPECT_EQ(error_of({{"ROS_LOCALHOST_ONLY", "yes"}}),
            "ROS_LOCALHOST_ONLY is 'yes'; write 1 for this machine alone, or 0 [SL0510]");
  EXPECT_EQ(
      error_of({{"ROS_STATIC_PEERS", "192.0.2.7, 192.0.2.8"}}),
      "ROS_STATIC_PEERS has '192.0.2.7, 192.0.2.8', which is not an address; write host names or "
      "IP addresses with ';' between them [SL0510]");
}

TEST(DiscoveryTest, settings_multicast_beyond_this_machine_in_the_subnet_alone) {
  const std::string subnet = cyclone_settings(parse({}), kNetwork, 0);
  EXPECT_THAT(subnet, HasSubstr("<AllowMulticast>spdp</AllowMulticast>"));
  EXPECT_THAT(subnet, HasSubstr("autodetermine=\"true\""));
  EXPECT_THAT(subnet, HasSubstr("<Peer address=\"127.0.0.1\"/><Peer address=\"192.0.2.2\"/>"));
  const std::string here = cyclone_settings(parse({{"ROS_LOCALHOST_ONLY", "1"}}), kNetwork, 0);
  EXPECT_THAT(here, HasSubstr("<AllowMulticast>false</AllowMulticast>"));
  const std::string own =
      cyclone_settings(parse({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT"}}), kNetwork, 0);
  EXPECT_THAT(own, Not(HasSubstr("AllowMulticast")));
  EXPECT_THAT(own, Not(HasSubstr("Peer")));
}

TEST(DiscoveryTest, a_machine_without_a_network_has_its_loopback_interface) {
  const std::string settings = cyclone_settings(parse({}), {}, 0);
  EXPECT_THAT(settings, Not(HasSubstr("autodetermine")));
  EXPECT_THAT(settings, HasSubstr("<NetworkInterface name=\"lo\" multicast=\"true\"/>"));
  EXPECT_THAT(settings, HasSubstr("<Peers><Peer address=\"127.0.0.1\"/></Peers>"));
}

TEST(DiscoveryTest, cyclonedds_uri_has_the_last_word) {
  EXPECT_THAT(cyclone_settings(parse({{"CYCLONEDDS_URI", "<Tracing/>"}}), kNetwork, 0),
              testing::EndsWith("</CycloneDDS>,<Tracing/>"));
}

TEST(DiscoveryTest, interfaces_in_cyclonedds_uri_take_the_place_of_ours) {
  const test::TemporaryDirectory directory;
  const std::string xml =
      "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"eth7\"/></Interfaces>"
      "</General></Domain></CycloneDDS>";
  const std::string file = directory.write("cyclone.xml", xml);
  for (const std::string& uri : {xml, file, "file://" + file, "<Tracing/>,file://" + file}) {
    EXPECT_THAT(cyclone_settings(parse({{"CYCLONEDDS_URI", uri}}), kNetwork, 0),
                Not(HasSubstr("autodetermine")))
        << uri;
  }
  EXPECT_THAT(cyclone_settings(parse({{"CYCLONEDDS_URI", "/nowhere.xml"}}), kNetwork, 0),
              HasSubstr("autodetermine"));
}

TEST(DiscoveryTest, this_machine_has_a_loopback_interface) {
  EXPECT_EQ(interfaces().loopback, "lo");
}

}  // namespace
