#include "reachability.hpp"

#include <fmt/format.h>
#include <ros/names.h>
#include <ros/this_node.h>
#include <ros/topic_manager.h>
#include <ros/transport/transport_tcp.h>
#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpcException.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "ask.hpp"
#include "connections.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"

namespace spikeloop::ros1 {
namespace {

/// Also topics with a connection are compared for this time after their first look.
constexpr TimeNs kFirstLooks = 5 * kNsPerSecond;
constexpr TimeNs kPeriod = kNsPerSecond / 2;
constexpr TimeNs kLaterPeriod = 2 * kNsPerSecond;
/// A connection that is missing for less time may be under way.
constexpr TimeNs kConnecting = kNsPerSecond;
constexpr TimeNs kPatience = 2 * kNsPerSecond;  // time limit of one question

std::string describe(const Fault& fault, const Address& address) {
  switch (fault.kind) {
    case Fault::Kind::unresolved:
      return unresolved_host(address.host, fault.reason) +
             ", or start that node with ROS_IP set to its machine's address";
    case Fault::Kind::ipv6_only:
      return fmt::format(
          "the host name '{}' has IPv6 addresses only; set ROS_IPV6=on for this program, or start "
          "that node with ROS_IP set to its machine's IPv4 address",
          address.host);
    default:
      return fmt::format(
          "no node answers at {}:{} ({}); if that node has ended, run 'rosnode cleanup'; if it "
          "runs, start it with ROS_IP set to an address that this machine reaches",
          address.host, address.port, fault.reason);
  }
}

/// Variable that determines the host name of this node.
std::string own_setting() {
  for (const char* name : {"ROS_HOSTNAME", "ROS_IP"}) {
    if (const char* const value = std::getenv(name); value != nullptr && *value != '\0') {
      return fmt::format("{}={}", name, value);
    }
  }
  return "the host name of this machine";
}

}  // namespace

struct ReachabilityWatch::Impl {
  explicit Impl(const std::string& uri) : master(parse_master_uri(uri)) {}

  Limit limit() const { return {wall_now() + kPatience, &ending, ros::TransportTCP::s_use_ipv6_}; }

  /// @return false if the watch ends
  bool wait(TimeNs time) {
    std::unique_lock lock(mutex);
    changed.wait_for(lock, std::chrono::nanoseconds(time), [&] { return ending.load(); });
    return !ending;
  }

  void run() {
    warn_of_own_address();
    while (wait(wall_now() < look_often_until ? kPeriod : kLaterPeriod)) {
      // A master that hangs would hold a call of roscpp.
      if (has_missing_connection() && !ask_for_pid(master, limit())) {
        look();
      }
    }
  }

  void warn_of_own_address() const {
    const auto own = parse_uri(ros::XMLRPCManager::instance()->getServerURI());
    if (!own) {
      return;
    }
    const std::string towards_master = own_address_towards(master);
    std::string reason;
    if (const auto fault = ask_for_pid(*own, limit()); fault && !ending) {
      reason = fmt::format("which {} ({})",
                           fault->kind == Fault::Kind::unresolved ? "cannot be resolved"
                                                                  : "does not lead to this node",
                           fault->reason);
    } else if (is_loopback(own->host) && !towards_master.empty()) {
      reason = "which only this machine reaches, and the ROS master is on another one";
    } else {
      return;
    }
    log::warning(
        "other nodes cannot connect to this one: it is registered at host '{}' ({}), {}; set "
        "ROS_IP "
        "to {}{}",
        own->host, own_setting(), reason,
        towards_master.empty()
            ? "this machine's address, 127.0.0.1 if all nodes are on this machine"
            : towards_master,
        std::getenv("ROS_HOSTNAME") != nullptr ? ", and unset ROS_HOSTNAME, which overrides it"
                                               : "");
  }

  bool has_missing_connection() {
    const auto& manager = ros::TopicManager::instance();
    const TimeNs now = wall_now();
    bool missing = false;
    const auto check = [&](const std::string& topic, std::size_t connections) {
      if (known.insert(topic).second) {
        look_often_until = now + kFirstLooks;
      }
      missing = missing || connections == 0 || now < look_often_until;
    };
    std::vector<std::string> topics;
    manager->getSubscribedTopics(topics);
    for (const std::string& topic : topics) {
      check(topic, manager->getNumPublishers(topic));
    }
    topics.clear();
    manager->getAdvertisedTopics(topics);
    for (const std::string& topic : topics) {
      check(topic, manager->getNumSubscribers(topic));
    }
    return missing;
  }

  void look() {
    const auto now = wall_now();
    std::map<Link, TimeNs> still;
    for (const Link& link : missing_links(self)) {
      const auto before = missing_since.find(link);
      const TimeNs since = before == missing_since.end() ? now : before->second;
      still.emplace(link, since);
      if (now - since >= kConnecting && !ending) {
        examine(link);
      }
    }
    missing_since = std::move(still);
  }

  void examine(const Link& link) {
    if (!examined.insert(link).second) {
      return;
    }
    if (const std::string problem = problem_of(link); !problem.empty() && !ending) {
      {
        const std::lock_guard lock(mutex);
        warned.insert(link.topic);
      }
      log::warning("topic '{}': no connection with its {} {}: {}", link.topic,
                   link.is_publisher ? "publisher" : "subscriber", link.node, problem);
    }
  }

  std::string problem_of(const Link& link) const {
    const auto address = parse_uri(link.uri);
    if (!address) {
      return {};
    }
    if (const auto fault = ask_for_pid(*address, limit())) {
      return describe(*fault, *address);
    }
    const auto data = link.is_publisher ? data_address(self, link) : std::nullopt;
    if (const auto fault = data ? connect_only(*data, limit()) : std::nullopt) {
      return describe(*fault, *data);
    }
    return {};
  }

  const Address master;
  const std::string self = ros::this_node::getName();
  std::set<std::string> known;  // topics of this process
  TimeNs look_often_until = wall_now() + kFirstLooks;
  std::map<Link, TimeNs> missing_since;
  std::set<Link> examined;
  std::atomic<bool> ending{false};
  mutable std::mutex mutex;  // of the members below
  std::condition_variable changed;
  std::set<std::string> warned;
  std::thread thread;
};

ReachabilityWatch::ReachabilityWatch(const std::string& master_uri)
    : impl_(std::make_unique<Impl>(master_uri)) {
  impl_->thread = std::thread([this] {
    try {
      impl_->run();
    } catch (const XmlRpc::XmlRpcException& error) {
      log::warning("the ROS master's answer cannot be read: {}", error.getMessage());
    }
  });
}

ReachabilityWatch::~ReachabilityWatch() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->ending = true;
  }
  impl_->changed.notify_one();
  impl_->thread.join();
}

bool ReachabilityWatch::has_warned(const std::string& topic) const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->warned.contains(topic);
}

}  // namespace spikeloop::ros1
