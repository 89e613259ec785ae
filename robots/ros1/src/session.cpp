#include "spikeloop/ros1/session.hpp"

#include <fmt/format.h>

#include <atomic>
#include <stdexcept>

#include "session_impl.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/ros1/master.hpp"

namespace spikeloop::ros1 {

void check_topic(const std::string& topic) {
  std::string reason;
  if (topic.empty() || !ros::names::validate(topic, reason)) {
    throw ConfigurationError(fmt::format(
        "ros_topic '{}' is no name of a topic; write letters, digits, '_' and '/', as in /cmd_vel",
        topic));
  }
}

Session::Session(const SessionSettings& settings) : impl_(std::make_unique<Impl>()) {
  static std::atomic<bool> used{false};
  const std::string uri = settings.master_uri.empty() ? master_uri() : settings.master_uri;
  std::string reason;
  if (settings.node_name.empty() || settings.node_name.find('/') != std::string::npos ||
      !ros::names::validate(settings.node_name, reason)) {
    throw ConfigurationError(fmt::format(
        "ros_node_name '{}' is no name of a node; write a letter followed by letters, digits and "
        "'_'",
        settings.node_name));
  }
  require_master(uri, settings.master_timeout);
  if (used.exchange(true)) {
    throw std::logic_error("a process has one ROS 1 session");
  }
  std::uint32_t options = ros::init_options::NoSigintHandler | ros::init_options::NoRosout;
  if (settings.unique_name) {
    options |= ros::init_options::AnonymousName;
  }
  ros::init(ros::M_string{{"__master", uri}}, settings.node_name, options);
  // The master answered a moment ago; should it die now, calls fail rather than wait for ever.
  ros::master::setRetryTimeout(ros::WallDuration(to_seconds(settings.master_timeout)));
  impl_->node = std::make_unique<ros::NodeHandle>();
  impl_->node->setCallbackQueue(&impl_->queue);
  impl_->thread = std::thread([this] {
    while (!impl_->ending.load()) {
      impl_->queue.callAvailable(ros::WallDuration(0.1));
    }
  });
}

Session::~Session() {
  impl_->ending.store(true);
  impl_->queue.disable();
  impl_->thread.join();
  ros::shutdown();
}

std::string Session::node_name() const {
  return ros::this_node::getName();
}

}  // namespace spikeloop::ros1
