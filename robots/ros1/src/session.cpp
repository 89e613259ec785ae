#include "spikeloop/ros1/session.hpp"

#include <fmt/format.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <atomic>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "connections.hpp"
#include "console.hpp"
#include "raw_publisher.hpp"
#include "raw_subscriber.hpp"
#include "reachability.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/ros1/master.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::ros1 {
namespace {

std::string checked_node_name(const SessionSettings& settings) {
  const auto argument = settings.arguments.find("__name");
  const std::string& name =
      argument == settings.arguments.end() ? settings.node_name : argument->second;
  topics::check_node_name(messages::Dialect::ros1, name);
  return name;
}

void start_ros(const ros::M_string& arguments, const std::string& node_name,
               std::uint32_t options) {
  try {
    ros::init(arguments, node_name, options);
    redirect_roscpp_log();
  } catch (const ros::InvalidNameException& error) {
    throw ConfigurationError(with_code(Code::invalid_topic,
                                       "an argument NAME:=VALUE for ROS has no name of ROS: {}",
                                       error.what()));
  }
}

}  // namespace

std::string master_of(const SessionSettings& settings) {
  const auto place = settings.place.find(kMasterVariable);
  return place == settings.place.end() ? master_uri(settings.arguments) : place->second;
}

struct Session::Impl {
  std::string master_uri;
  ros::CallbackQueue queue;
  std::unique_ptr<ros::NodeHandle> node;
  std::atomic<bool> ending{false};
  std::thread thread;
  std::unique_ptr<ReachabilityWatch> watch;
};

Session::Session(const SessionSettings& settings) : impl_(std::make_unique<Impl>()) {
  static std::atomic<bool> used{false};
  const std::string uri = master_of(settings);
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
  // The master has just answered. If it dies now, calls must fail instead of waiting without limit.
  ros::master::setRetryTimeout(ros::WallDuration(to_seconds(settings.master_timeout)));
  impl_->master_uri = uri;
  impl_->node = std::make_unique<ros::NodeHandle>();
  impl_->node->setCallbackQueue(&impl_->queue);
  impl_->thread = std::thread([this] {
    while (!impl_->ending.load()) {
      impl_->queue.callAvailable(ros::WallDuration(0.1));
    }
  });
  if (settings.warn_of_unreachable_nodes) {
    impl_->watch = std::make_unique<ReachabilityWatch>(uri);
  }
}

Session::~Session() {
  impl_->watch.reset();
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
    throw TransportError(with_code(
        Code::partner_failed,
        "the ROS node {} has been shut down: another node took its name, or it was ended by  "
        "rosnode kill",
        node_name()));
  }
}

topics::Place Session::place() const {
  return {{kMasterVariable, impl_->master_uri}};
}

std::string Session::whole_topic(const std::string& topic) const {
  return ros::names::resolve(topic);
}

std::unique_ptr<topics::RawPublisher> Session::publisher(const std::string& topic,
                                                         const std::string& message_type,
                                                         std::uint32_t queue, bool latched) {
  return std::make_unique<RawPublisher>(*impl_->node, topic, message_type, queue, latched);
}

std::unique_ptr<topics::RawSubscriber> Session::subscriber(topics::Subscription subscription) {
  auto subscriber = std::make_unique<RawSubscriber>(*impl_->node, std::move(subscription));
  if (impl_->watch) {
    impl_->watch->add(subscriber->receiver());
  }
  return subscriber;
}

bool Session::has_publishers(const std::string& topic) const {
  return ros1::has_publishers(node_name(), topic);
}

std::vector<topics::Partner> Session::subscribers(const std::string& topic) const {
  return impl_->watch ? impl_->watch->refused_subscribers(topic) : std::vector<topics::Partner>{};
}

bool Session::has_warned_of_unreachable_node(const std::string& topic) const {
  return impl_->watch && impl_->watch->has_warned_of(topic);
}

bool Session::is_connected_to_publisher(const std::string& topic) const {
  return ros1::is_connected_to_publisher(node_name(), topic);
}

bool Session::publishers_are_connected(const std::string& topic) const {
  return all_publishers_connected(node_name(), topic);
}

}  // namespace spikeloop::ros1
