#include "reachability.hpp"

#include <fmt/format.h>
#include <ros/names.h>
#include <ros/publication.h>
#include <ros/this_node.h>
#include <ros/topic_manager.h>
#include <ros/transport/transport_tcp.h>
#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpcException.h>

#include <algorithm>
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

/// Time after the first appearance of a topic in which its connections are checked more often.
constexpr TimeNs kFirstLooks = 5 * kNsPerSecond;
constexpr TimeNs kPeriod = kNsPerSecond / 5;
constexpr TimeNs kLaterPeriod = 2 * kNsPerSecond;
/// A connection that is missing for less time may be under way.
constexpr TimeNs kConnecting = kNsPerSecond;
constexpr TimeNs kPatience = 2 * kNsPerSecond;  // time limit of a request

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
    while (wait(wall_now() < look_often_until || is_examining() ? kPeriod : kLaterPeriod)) {
      note_new_topics();
      // A master that hangs would hold a call of roscpp.
      if (!ask_for_pid(master, limit())) {
        compare_connections();
      }
    }
  }

  void warn_of_own_address() {
    const bool wrong = has_wrong_address();
    const std::lock_guard lock(mutex);
    own_address = wrong ? OwnAddress::wrong : OwnAddress::right;
  }

  /// Also logs the warning.
  bool has_wrong_address() const {
    const auto own = parse_uri(ros::XMLRPCManager::instance()->getServerURI());
    if (!own) {
      return false;
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
      return false;
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
    return true;
  }

  void note_new_topics() {
    const auto& manager = ros::TopicManager::instance();
    for (const auto list :
         {&ros::TopicManager::getSubscribedTopics, &ros::TopicManager::getAdvertisedTopics}) {
      std::vector<std::string> topics;
      ((*manager).*list)(topics);
      for (const std::string& topic : topics) {
        if (known.insert(topic).second) {
          look_often_until = wall_now() + kFirstLooks;
        }
      }
    }
  }

  void compare_connections() {
    const auto now = wall_now();
    std::map<Link, Missing> still;
    for (const Link& link : missing_links(self)) {
      const auto before = missing.find(link);
      still.emplace(link, before == missing.end() ? Missing{now, false} : before->second);
    }
    {
      const std::lock_guard lock(mutex);
      missing = std::move(still);
    }
    for (auto& [link, state] : missing) {
      const bool is_new = state.since == now;  // its connection may be under way
      if (!state.examined && !is_new && !ending) {
        const bool done = examine(link, now - state.since);
        const std::lock_guard lock(mutex);
        state.examined = done;
      }
    }
  }

  /// @return false if the connection may still be under way
  bool examine(const Link& link, TimeNs since) {
    const auto address = parse_uri(link.uri);
    if (!address) {
      return true;
    }
    Address asked = *address;
    auto fault = ask_for_pid(asked, limit());
    if (!fault && (link.is_publisher ? has_other_type(link) : takes_other_type(link))) {
      return true;
    }
    if (since < kConnecting) {
      return false;
    }
    if (!fault && link.is_publisher) {
      fault = ask_for_version(link, asked);
    }
    if (fault && !ending) {
      {
        const std::lock_guard lock(mutex);
        warned.insert(link.topic);
      }
      log::warning("topic '{}': no connection with its {} {}: {}", link.topic,
                   link.is_publisher ? "publisher" : "subscriber", link.node,
                   describe(*fault, asked));
    }
    return true;
  }

  /// Reports another type to the subscriptions of the topic.
  bool has_other_type(const Link& publisher) {
    return refuse_other_type(publisher.topic,
                             {{"type", type_of(self, publisher)}, {"callerid", publisher.node}});
  }

  /// Reports another version of the type. The publisher counts the question as a subscriber, so it
  /// is asked only if the connection is overdue.
  /// @param asked receives the address of the publisher's messages
  /// @return reason of a missing answer
  std::optional<Fault> ask_for_version(const Link& publisher, Address& asked) {
    const auto data = data_address(self, publisher);
    if (!data) {
      return std::nullopt;
    }
    asked = *data;
    PublisherHeader header;
    auto fault = ask_for_header(asked, limit(), self, publisher.topic, header);
    if (!fault) {
      refuse_other_type(publisher.topic, header);
    }
    return fault;
  }

  bool refuse_other_type(const std::string& topic, const PublisherHeader& header) {
    bool other = false;
    for (const auto& receiver : receivers_of(topic)) {
      other = receiver->refuse_other_type(header) || other;
    }
    return other;
  }

  bool takes_other_type(const Link& subscriber) {
    const std::string type = type_of(self, subscriber);
    const auto publication = ros::TopicManager::instance()->lookupPublication(subscriber.topic);
    if (type.empty() || !publication || publication->getDataType() == type) {
      return false;
    }
    const std::lock_guard lock(mutex);
    refused[subscriber.topic].push_back({.node = subscriber.node, .type = type});
    return true;
  }

  std::vector<std::shared_ptr<Receiver>> receivers_of(const std::string& topic) {
    const std::lock_guard lock(mutex);
    std::vector<std::shared_ptr<Receiver>> found;
    std::erase_if(receivers, [](const auto& receiver) { return receiver.expired(); });
    for (const auto& receiver : receivers) {
      const auto alive = receiver.lock();
      if (alive && ros::names::resolve(alive->wanted().topic) == topic) {
        found.push_back(alive);
      }
    }
    return found;
  }

  bool is_examining() const {
    return std::ranges::any_of(missing, [](const auto& entry) { return !entry.second.examined; });
  }

  /// A link without a connection.
  struct Missing {
    TimeNs since = 0;
    bool examined = false;
  };
  enum class OwnAddress : std::uint8_t { unknown, right, wrong };

  const Address master;
  const std::string self = ros::this_node::getName();
  std::set<std::string> known;  // topics of this process
  TimeNs look_often_until = wall_now() + kFirstLooks;
  std::atomic<bool> ending{false};
  mutable std::mutex mutex;  // protects the members below
  std::condition_variable changed;
  std::map<Link, Missing> missing;  // written by the thread of the watch only
  OwnAddress own_address = OwnAddress::unknown;
  std::set<std::string> warned;
  std::map<std::string, std::vector<topics::Partner>> refused;
  std::vector<std::weak_ptr<Receiver>> receivers;
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

void ReachabilityWatch::add(const std::shared_ptr<Receiver>& receiver) {
  const std::lock_guard lock(impl_->mutex);
  impl_->receivers.push_back(receiver);
}

bool ReachabilityWatch::has_warned_of(const std::string& topic) const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->own_address != Impl::OwnAddress::right || impl_->warned.contains(topic) ||
         std::ranges::any_of(impl_->missing, [&](const auto& entry) {
           return entry.first.topic == topic && !entry.second.examined;
         });
}

std::vector<topics::Partner> ReachabilityWatch::refused_subscribers(
    const std::string& topic) const {
  const std::lock_guard lock(impl_->mutex);
  const auto found = impl_->refused.find(topic);
  return found == impl_->refused.end() ? std::vector<topics::Partner>{} : found->second;
}

}  // namespace spikeloop::ros1
