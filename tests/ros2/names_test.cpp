// Names of topics, nodes and types in ROS 2.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/core/error.hpp"
#include "spikeloop/ros2/names.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/fault.hpp"

namespace {

using spikeloop::test::Fault;
using namespace spikeloop;
using namespace spikeloop::ros2;
using test::error_of;

std::string whole(const std::string& topic, const topics::RosArguments& arguments) {
  const NodeIdentity node = node_identity("brain", arguments);
  return TopicNames(node, arguments).whole(topic);
}

TEST(Ros2Names, a_topic_is_within_the_namespace_unless_it_is_absolute) {
  EXPECT_EQ(whole("scan", {}), "/scan");
  EXPECT_EQ(whole("/scan", {}), "/scan");
  EXPECT_EQ(whole("~/scan", {}), "/brain/scan");
  EXPECT_EQ(whole("left/scan", {{"__ns", "/arena"}}), "/arena/left/scan");
  EXPECT_EQ(whole("scan", {{"__ns", "arena/left"}}), "/arena/left/scan");
  EXPECT_EQ(whole("/scan", {{"__ns", "/arena"}}), "/scan");
  EXPECT_EQ(whole("~/scan", {{"__ns", "/arena"}, {"__name", "robot"}}), "/arena/robot/scan");
  EXPECT_EQ(whole("scan", {{"__ns", "/"}}), "/scan");
}

TEST(Ros2Names, remapping_compares_whole_names_and_counts_once) {
  EXPECT_EQ(whole("scan", {{"scan", "/front/scan"}}), "/front/scan");
  EXPECT_EQ(whole("/scan", {{"scan", "front"}}), "/front");
  EXPECT_EQ(whole("scan", {{"/arena/scan", "front"}, {"__ns", "/arena"}}), "/arena/front");
  EXPECT_EQ(whole("~/scan", {{"~/scan", "/scan"}}), "/scan");
  EXPECT_EQ(whole("a", {{"a", "b"}, {"b", "c"}}), "/b");
  EXPECT_EQ(whole("other", {{"scan", "/front/scan"}}), "/other");
}

TEST(Ros2Names, a_rule_may_be_for_one_node) {
  EXPECT_EQ(whole("scan", {{"brain:scan", "/front"}}), "/front");
  EXPECT_EQ(whole("scan", {{"robot:scan", "/front"}}), "/scan");
}

TEST(Ros2Names, says_what_is_no_name) {
  EXPECT_THAT(error_of([] { node_identity("my node", {}); }),
              Fault("'my node' ... ROS node name ... digits and '_' ... [SL0501]"));
  EXPECT_EQ(error_of([] {
              node_identity("brain", {{"__ns", "/a//b"}});
            }),
            "'/a//b' is not a namespace of ROS 2; write letters, digits, '_' and '/', as in "
            "__ns:=/arena/left [SL0106]");
  EXPECT_THAT(error_of([] {
                whole("scan", {{"sc an", "/front"}});
              }),
              Fault("... 'sc an' ... ROS 2 topic name ... [SL0501] ..."));
  EXPECT_THAT(error_of([] {
                whole("scan", {{"scan", "1"}});
              }),
              Fault("... '1' ... ROS 2 topic name ... [SL0501] ..."));
  EXPECT_THAT(error_of([] { whole("~scan", {}); }),
              Fault("... '~scan' ... ROS 2 topic name ... [SL0501] ..."));
}

TEST(Ros2Names, a_topic_in_dds_has_a_prefix) {
  EXPECT_EQ(dds_topic("/arena/scan"), "rt/arena/scan");
  EXPECT_EQ(dds_topic("/" + std::string(247, 'a')).size(), 250U);
  EXPECT_EQ(error_of([] { dds_topic("/" + std::string(248, 'a')); }),
            "the topic '/" + std::string(248, 'a') +
                "' has 249 characters; ROS 2 takes 248 at most, so write a shorter name [SL0501]");
}

TEST(Ros2Names, a_type_in_dds_has_its_package_as_a_module) {
  EXPECT_EQ(dds_type("sensor_msgs/LaserScan"), "sensor_msgs::msg::dds_::LaserScan_");
  EXPECT_EQ(ros_type("sensor_msgs::msg::dds_::LaserScan_"), "sensor_msgs/LaserScan");
  EXPECT_EQ(ros_type("HelloWorld"), "HelloWorld");
}

}  // namespace
