// Commands as roscpp's own subscribers get them.
#include "spikeloop/topics/publisher.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/core/error.hpp"
#include "tests/ros1/ros_peer.hpp"
#include "tests/ros1/settings.hpp"
#include "tests/support/roscore.hpp"

namespace {

using namespace spikeloop;
using namespace spikeloop::topics;
using ros_peer::eventually;
using testing::ElementsAre;

class PublisherTest : public testing::Test {
 protected:
  test::RosCore core_;
  ros1::Session session_{test::node_at(core_.uri(), "command")};
  ros_peer::Peer robot_{core_.uri()};
};

TEST_F(PublisherTest, twist) {
  Publisher publisher(session_, "/cmd_vel", "geometry_msgs/Twist", {"angular.z", "linear.x"});
  robot_.listen_twist("/cmd_vel");
  const double values[] = {0.25, -0.5};
  ASSERT_TRUE(eventually(20, [&] {
    publisher.publish(values);
    return !robot_.twists().empty();
  }));
  EXPECT_EQ(robot_.twists().front().linear_x, -0.5);
  EXPECT_EQ(robot_.twists().front().angular_z, 0.25);
}

TEST_F(PublisherTest, array_of_all_values) {
  Publisher publisher(session_, "/motors", "std_msgs/Float64MultiArray", {"data"});
  robot_.listen_array("/motors");
  const double values[] = {1, 2, 3};
  ASSERT_TRUE(eventually(20, [&] {
    publisher.publish(values);
    return !robot_.arrays().empty();
  }));
  EXPECT_THAT(robot_.arrays().front(), ElementsAre(1, 2, 3));
}

TEST_F(PublisherTest, errors) {
  const auto error_of = [&](const std::string& topic, const std::string& type,
                            const std::string& field) {
    try {
      Publisher(session_, topic, type, {field});
    } catch (const ConfigurationError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(error_of("a b", "geometry_msgs/Twist", "linear.x"),
            "'a b' is no name of a ROS topic; write letters, digits, '_' and '/', beginning with a "
            "letter or '/', as in /cmd_vel");
  EXPECT_EQ(error_of("/a", "geometry_msgs/Twist", "linear.w"),
            "field path 'linear.w' of geometry_msgs/Twist: geometry_msgs/Vector3 has no field 'w'; "
            "did you mean 'x'?");
}

}  // namespace
