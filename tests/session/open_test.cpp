#include "spikeloop/session/open.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <string>

#include "spikeloop/core/error.hpp"
#include "spikeloop/session/rclcpp.hpp"

namespace spikeloop::session {
namespace {

using ::testing::HasSubstr;

class Transport : public ::testing::Test {
 protected:
  void TearDown() override { ::unsetenv(kTransportVariable); }

  template <typename Error>
  std::string error_with(const char* transport) {
    ::setenv(kTransportVariable, transport, 1);
    try {
      open({{.node_name = "test"}, messages::Dialect::ros2});
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(Transport, UnknownOne) {
  EXPECT_EQ(error_with<ConfigurationError>("zenoh"),
            "SPIKELOOP_ROS2 is 'zenoh'; write rclcpp, or cyclonedds (the default) [SL0510]");
}

// Continuous integration has no ROS 2, and no workspace in which the library was built.
TEST_F(Transport, RclcppWithoutItsLibrary) {
  const std::string error = error_with<TransportError>("rclcpp");
  EXPECT_THAT(error,
              HasSubstr("cannot take part in ROS 2 by rclcpp: libspikeloop_rclcpp.so: cannot "
                        "open shared object file"));
  EXPECT_THAT(error, HasSubstr("build the ROS package spikeloop_ros with colcon, and source its "
                               "setup.bash (docs/ros2.md), or unset SPIKELOOP_ROS2"));
}

}  // namespace
}  // namespace spikeloop::session
