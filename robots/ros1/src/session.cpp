#include "spikeloop/ros1/session.hpp"

#include <fmt/format.h>

#include <atomic>
#include <stdexcept>

#include "session_impl.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/ros1/master.hpp"

namespace spikeloop::ros1 {

namespace {

/// A '~' makes a name private to a node; roscpp wants none in these.
bool is_name(const std::string& name, const char* unwanted) {
  std::string reason;
  return !name.empty() && name.find_first_of(unwanted) == std::string::npos &&
         ros::names::validate(name, reason);
}

std::string checked_node_name(const SessionSettings& settings) {
  const auto argument = settings.arguments.find("__name");
  const std::string& name =
      argument == settings.arguments.end() ? settings.node_name : argument->second;
  check_node_name(name);
  return name;
}

void start_ros(const ros::M_string& arguments, const std::string& node_name,
               std::uint32_t options) {
  try {
    ros::init(arguments, node_name, options);
  } catch (const ros::InvalidNameException& error) {
    throw ConfigurationError(
        fmt::format("an argument NAME:=VALUE for ROS has no name of ROS: {}", error.what()));
  }
}

}  // namespace

void check_node_name(const std::string& name) {
  if (!is_name(name, "~/")) {
    throw ConfigurationError(fmt::format(
        "'{}' is no name of a ROS node; write a letter followed by letters, digits and '_'", name));
  }
}

void check_topic(const std::string& topic) {
  if (!is_name(topic, "~")) {
    throw ConfigurationError(fmt::format(
        "'{}' is no name of a ROS topic; write letters, digits, '_' and '/', beginning with a "
        "letter or '/', as in /cmd_vel",
        topic));
  }
}

std::string whole_topic(const std::string& topic) {
  return ros::names::resolve(topic);
}

Session::Session(const SessionSettings& settings) : impl_(std::make_unique<Impl>()) {
  static std::atomic<bool> used{false};
  const std::string uri =
      settings.master_uri.empty() ? master_uri(settings.arguments) : settings.master_uri;
  const std::string node_name = checked_node_name(settings);
  require_master(uri, settings.master_timeout);
  if (used.exchange(true)) {
    throw std::logic_error("a process has one ROS 1 session");
  }
  std::uint32_t options = ros::init_options::NoSigintHandler | ros::init_options::NoRosout;
  if (settings.unique_name) {
    options |= ros::init_options::AnonymousName;
  }
  ros::M_string arguments = settings.arguments;
  arguments["__master"] = uri;
  start_ros(arguments, node_name, options);
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

bool Session::alive() const {
  return ros::ok();
}

void Session::require_alive() const {
  if (!alive()) {
    throw TransportError(fmt::format(
        "the ROS node {} has been shut down: another node took its name, or somebody ended it "
        "(rosnode kill)",
        node_name()));
  }
}

}  // namespace spikeloop::ros1
