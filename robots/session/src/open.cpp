#include "spikeloop/session/open.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/open_library.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/ros1/master.hpp"
#include "spikeloop/ros1/session.hpp"
#include "spikeloop/ros2/session.hpp"
#include "spikeloop/session/rclcpp.hpp"

namespace spikeloop::session {
namespace {

/// What makes nodes of ROS 2: as another session does, or the environment says.
/// @throws ConfigurationError for a value that is none.
bool is_by_rclcpp(const topics::Place& place) {
  const char* const variable = std::getenv(kTransportVariable);
  std::string transport = variable == nullptr ? "" : variable;
  if (!place.empty()) {
    const auto other = place.find(kTransportVariable);
    transport = other == place.end() ? "" : other->second;
  }
  if (transport.empty() || transport == "cyclonedds") {
    return false;
  }
  if (transport != kRclcpp) {
    throw ConfigurationError(with_code(Code::ros_setting,
                                       "{} is '{}'; write rclcpp, or cyclonedds (the default)",
                                       kTransportVariable, transport));
  }
  return true;
}

/// ROS 2 ends the process when it does not find it. Its own symbols first: it may have another
/// Cyclone DDS than we.
void open_middleware() {
  const char* const name = std::getenv("RMW_IMPLEMENTATION");
  if (name != nullptr && *name != '\0') {
    static const std::string file = fmt::format("lib{}.so", name);
    static const OpenLibrary middleware(
        file.c_str(), "use the middleware that RMW_IMPLEMENTATION names",
        "write one that is installed, as rmw_fastrtps_cpp", OpenLibrary::Symbols::own_first);
  }
}

std::string full_type(const std::string& message_type) {
  return messages::Catalog::for_type(messages::Dialect::ros2, message_type).full_name(message_type);
}

std::unique_ptr<topics::Session> open_by_rclcpp(const topics::SessionSettings& settings) {
  open_middleware();
  static const OpenLibrary library(kRclcppLibrary, "take part in ROS 2 by rclcpp",
                                   "build the ROS package spikeloop_ros with colcon, and source "
                                   "its setup.bash (docs/ros2.md), or "
                                   "unset SPIKELOOP_ROS2");
  return std::unique_ptr<topics::Session>(
      library.function<RclcppFactory*>(kRclcppFactory)(settings, full_type));
}

}  // namespace

std::unique_ptr<topics::Session> open(const Settings& settings) {
  if (settings.ros == messages::Dialect::ros2) {
    return is_by_rclcpp(settings.place) ? open_by_rclcpp(settings)
                                        : std::make_unique<ros2::Session>(settings);
  }
  ros1::SessionSettings ros1{settings, settings.master_timeout};
  if (settings.cancelled != nullptr &&
      !ros1::require_master(ros1::master_of(ros1), settings.master_timeout, settings.cancelled)) {
    return nullptr;
  }
  return std::make_unique<ros1::Session>(ros1);
}

}  // namespace spikeloop::session
