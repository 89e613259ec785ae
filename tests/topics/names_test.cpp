#include "spikeloop/topics/names.hpp"

#include <gtest/gtest.h>

#include <string>

#include "spikeloop/core/error.hpp"
#include "tests/support/error_of.hpp"

namespace {

using namespace spikeloop;
using namespace spikeloop::topics;
using messages::Dialect;
using test::error_of;

TEST(Names, topics_of_both) {
  for (const Dialect ros : {Dialect::ros1, Dialect::ros2}) {
    for (const char* topic : {"/cmd_vel", "scan", "/a/b2/c_d", "/robot1/scan"}) {
      EXPECT_EQ(error_of([&] { check_topic(ros, topic); }), "no error") << topic;
    }
  }
}

TEST(Names, topics_of_ros1) {
  for (const std::string topic : {"", "1a", "_a", "a b", "~a", "/a-b", "/b\xc3\xbc"}) {
    EXPECT_EQ(
        error_of([&] { check_topic(Dialect::ros1, topic); }),
        "'" + topic +
            "' is not a valid ROS topic name; write letters, digits, '_' and '/', beginning with "
            "a letter or '/', as in /cmd_vel [SL0501]");
  }
  EXPECT_EQ(error_of([] { check_topic(Dialect::ros1, "/a/1b"); }), "no error");
}

TEST(Names, topics_of_ros2) {
  EXPECT_EQ(error_of([] { check_topic(Dialect::ros2, "~/scan"); }), "no error");
  EXPECT_EQ(error_of([] { check_topic(Dialect::ros2, "_a"); }), "no error");
  for (const std::string topic : {"", "/", "~", "~a", "1a", "/a/1b", "/a//b", "/a/", "a b", "a~"}) {
    EXPECT_EQ(error_of([&] { check_topic(Dialect::ros2, topic); }),
              "'" + topic +
                  "' is not a valid ROS 2 topic name; write letters, digits, '_' and '/', no part "
                  "beginning with a digit, as in /cmd_vel or ~/cmd_vel [SL0501]");
  }
}

TEST(Names, node_of_any_text) {
  EXPECT_EQ(as_node_name("spikeloop_my-loop 2"), "spikeloop_my_loop_2");
}

TEST(Names, nodes) {
  EXPECT_EQ(error_of([] { check_node_name(Dialect::ros1, "a_1"); }), "no error");
  EXPECT_EQ(error_of([] { check_node_name(Dialect::ros2, "_a"); }), "no error");
  for (const Dialect ros : {Dialect::ros1, Dialect::ros2}) {
    for (const std::string name : {"", "1a", "a/b", "~a", "a b"}) {
      EXPECT_EQ(
          error_of([&] { check_node_name(ros, name); }),
          "'" + name +
              "' is not a valid ROS node name; write a letter followed by letters, digits and "
              "'_' [SL0501]");
    }
  }
}

TEST(Names, versions) {
  for (const Dialect ros : {Dialect::ros1, Dialect::ros2}) {
    EXPECT_EQ(dialect_of(version_of(ros)), ros);
  }
  EXPECT_STREQ(name_of(Dialect::ros2), "ROS 2");
  EXPECT_STREQ(topic_command(Dialect::ros1), "rostopic");
  EXPECT_STREQ(topic_command(Dialect::ros2), "ros2 topic");
}

}  // namespace
