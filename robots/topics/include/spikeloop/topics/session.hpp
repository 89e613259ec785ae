// Interface to ROS 1 and ROS 2: a node, and publishers and subscribers of messages as bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/messages/dialect.hpp"
#include "spikeloop/topics/arguments.hpp"

namespace spikeloop::topics {

/// Publisher of a topic.
class RawPublisher {
 public:
  RawPublisher() = default;
  virtual ~RawPublisher() = default;
  RawPublisher(const RawPublisher&) = delete;
  RawPublisher& operator=(const RawPublisher&) = delete;

  /// Copies one whole message, in the session's dialect. Does not wait for subscribers. May be
  /// called from any thread, but not from two at the same time.
  virtual void publish(std::span<const std::byte> message) = 0;
  virtual bool has_subscribers() const = 0;
  /// Quality of service that subscribers of this topic request and this publisher does not offer,
  /// so that ROS 2 does not connect them ("durability transient local, but Spikeloop's publisher is
  /// volatile"). Empty if all are connected, and over ROS 1.
  virtual std::string misfit() const { return {}; }
  /// Waits until the system has all published messages, so that it delivers them even if this
  /// process dies.
  virtual void drain() const = 0;
  /// Waits until the reliable subscribers have acknowledged the published messages, for 100 ms at
  /// most. Does not wait over ROS 1.
  /// @return false if a subscriber has not acknowledged them
  virtual bool deliver() const {
    drain();
    return true;
  }
};

/// Subscription to a topic. Its callbacks are not called after its destruction.
class RawSubscriber {
 public:
  RawSubscriber() = default;
  virtual ~RawSubscriber() = default;
  RawSubscriber(const RawSubscriber&) = delete;
  RawSubscriber& operator=(const RawSubscriber&) = delete;

  virtual bool has_publishers() const = 0;
  /// Number of messages that did not reach `take`, because newer ones replaced them or the network
  /// lost them. Messages of a publisher count from the first known one. nullopt if messages have no
  /// numbers (ROS 1). The newest losses are counted when the next message arrives, or after a
  /// second without a message. This function updates the number: call it from time to time while no
  /// message arrives.
  virtual std::optional<std::uint64_t> lost() const { return std::nullopt; }
  /// Number of packets that this process has lost since its start because its receive buffers were
  /// full. Over ROS 2 a message is lost with one of its packets unless it is sent reliably.
  virtual std::uint64_t dropped_packets() const { return 0; }
  /// Quality of service that publishers of this topic offer and this subscriber does not accept, as
  /// RawPublisher::misfit().
  virtual std::string misfit() const { return {}; }
  /// True if the publishers send their newest message to late subscribers, so that a silent
  /// publisher has no newer message.
  virtual bool latched() const { return false; }
};

/// Type of a topic that differs from the type of the subscription.
struct OtherType {
  std::string type;  ///< type of the topic; empty: another version of the type
  std::string text;  ///< "topic '/scan' carries geometry_msgs/Twist, not sensor_msgs/LaserScan"
  /// Name of the publisher's node. Empty as long as it is unknown: over ROS 2 it arrives some
  /// milliseconds after the type.
  std::function<std::string()> node{};
};

OtherType other_type(const std::string& topic, const std::string& type, const std::string& wanted,
                     std::function<std::string()> node = {});

/// Remedy for another type: "write  message: geometry_msgs/TwistStamped ...".
std::string remedy_for_type(const std::string& type, const std::string& wanted);

/// A subscriber of another node.
struct Partner {
  std::string node;  ///< "/base"; empty if unknown
  std::string type;  ///< "geometry_msgs/Twist"
};

struct Subscription {
  std::string topic;
  std::string message_type;  ///< "sensor_msgs/LaserScan"
  /// Messages that may wait for the session's thread. If there are more, the oldest are lost. 1:
  /// only the newest; 0: unlimited. ROS 2: with 0, messages that the network loses are sent again,
  /// unless the publisher is best effort.
  std::uint32_t queue = 1;
  /// ROS 2: messages of a reliable publisher that the network loses are sent again with any queue.
  /// Use it for messages of many packets, which often arrive incomplete otherwise. Messages after a
  /// lost one wait for it, and a publisher may wait for a process that is stopped. Do not use it
  /// for small messages, where the next one is better than a late one.
  bool reliable = false;
  /// Also receive messages that were published before the subscription. ROS 2: if all publishers of
  /// the topic offer it (transient local); ROS 1 sends them to every subscriber.
  bool latched = false;
  /// Called in a thread of the session as soon as a message of this type has arrived. The bytes are
  /// valid until it returns. Must not throw.
  std::function<void(std::span<const std::byte> message)> take;
  /// Called in a thread of the session if the topic carries another type, or another version of
  /// this one, possibly repeatedly. Must not throw. May be empty.
  std::function<void(const OtherType& other)> refuse{};
};

/// Environment variables that determine which nodes can connect: ROS 1: ROS_MASTER_URI; ROS 2:
/// ROS_DOMAIN_ID and those that limit the discovery.
using Place = std::map<std::string, std::string>;

struct SessionSettings {
  std::string node_name;
  /// ROS 1: adds a unique suffix to the name, because the master ends the first of two nodes with
  /// the same name.
  bool unique_name = false;
  RosArguments arguments{};  ///< `__name` has priority over `node_name`
  Place place{};             ///< of another session; empty: of this process's environment
  bool warn_of_unreachable_nodes = true;  ///< ROS 1: also of other types
};

/// This process as a node of ROS 1 or ROS 2. Publishers and subscribers must end before it.
class Session {
 public:
  Session() = default;
  virtual ~Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  virtual messages::Dialect dialect() const = 0;
  virtual std::string node_name() const = 0;  ///< "/spikeloop_explorer"
  /// False after ROS has shut the node down: no message is received or sent any more.
  virtual bool alive() const = 0;
  /// @throws TransportError with the reason if the node is not alive.
  virtual void require_alive() const = 0;
  /// Logs out, for a process that ends without destroying the session: other nodes need not wait
  /// for a time-out. May be called from any thread; no message is received or sent afterwards.
  /// Takes 300 ms at most. Does nothing over ROS 1 and by rclcpp.
  virtual void leave() {}
  /// True if the topics stay inside this process, so that other programs cannot subscribe to them
  /// or stop a robot.
  virtual bool local() const { return false; }
  /// Place at which another process connects to the same nodes as this one.
  virtual Place place() const = 0;
  /// Full name of a topic: "/scan" of "scan", with namespace and remapping.
  virtual std::string whole_topic(const std::string& topic) const = 0;

  /// @param latched also sends the newest message to later subscribers (ROS 2: as many messages as
  /// the queue holds, to subscribers that request transient local)
  /// @throws ConfigurationError for an unknown type or an invalid topic.
  virtual std::unique_ptr<RawPublisher> publisher(const std::string& topic,
                                                  const std::string& message_type,
                                                  std::uint32_t queue = 10,
                                                  bool latched = false) = 0;
  /// @throws ConfigurationError for an unknown type or an invalid topic.
  virtual std::unique_ptr<RawSubscriber> subscriber(Subscription subscription) = 0;
  /// True if the topic has a publisher that the master of ROS 1 or the discovery of ROS 2 has
  /// reported so far.
  /// @param topic as returned by whole_topic()
  virtual bool has_publishers(const std::string& topic) const = 0;
  /// Known subscribers of a topic, of any type; over ROS 1 only those of another type than the
  /// publisher's. Never waits.
  /// @param topic as returned by whole_topic()
  virtual std::vector<Partner> subscribers(const std::string& /*topic*/) const { return {}; }
  /// True if the topic has publishers and all of them have connected this node, so that their next
  /// messages arrive.
  /// @param topic as returned by whole_topic()
  virtual bool publishers_are_connected(const std::string& topic) const = 0;
  /// True if a warning has named a node of this topic that cannot be connected, or a wrong address
  /// of this node, or if such a fault is being examined (ROS 1). Then warnings about missing
  /// messages or subscribers of the topic are not needed.
  /// @param topic as returned by whole_topic()
  virtual bool has_warned_of_unreachable_node(const std::string& /*topic*/) const { return false; }
  /// True if messages of at least one publisher of the topic can arrive, although others may be
  /// unreachable.
  /// @param topic as whole_topic() gives it
  virtual bool is_connected_to_publisher(const std::string& topic) const {
    return has_publishers(topic);
  }
};

}  // namespace spikeloop::topics
