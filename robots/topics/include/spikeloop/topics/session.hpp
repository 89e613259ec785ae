// What a process needs of ROS, whichever it is: a node, topics out, topics in, as bytes.
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

/// A topic out, message by message.
class RawPublisher {
 public:
  RawPublisher() = default;
  virtual ~RawPublisher() = default;
  RawPublisher(const RawPublisher&) = delete;
  RawPublisher& operator=(const RawPublisher&) = delete;

  /// Copies one whole message, in the session's dialect. Does not wait for subscribers. Safe to
  /// call from any thread, one at a time.
  virtual void publish(std::span<const std::byte> message) = 0;
  virtual bool has_subscribers() const = 0;
  /// Quality of service that subscribers of this topic request and it does not offer, so that ROS 2
  /// does not connect them ("durability transient local, but
  /// Spikeloop's publisher is volatile"). Empty if all
  /// are connected, and over ROS 1.
  virtual std::string misfit() const { return {}; }
  /// Returns when the system has what was published, and delivers it even when this process dies.
  virtual void drain() const = 0;
  /// Asks the reliable subscribers whether they have received what was published, and waits for
  /// their answer, 100 ms at most. Over ROS 1 they are not asked.
  /// @return false if one has not answered
  virtual bool deliver() const {
    drain();
    return true;
  }
};

/// A topic in. None of its functions is called any more once it is destroyed.
class RawSubscriber {
 public:
  RawSubscriber() = default;
  virtual ~RawSubscriber() = default;
  RawSubscriber(const RawSubscriber&) = delete;
  RawSubscriber& operator=(const RawSubscriber&) = delete;

  virtual bool has_publishers() const = 0;
  /// Messages that its publishers have sent since the first that was heard of from each, and that
  /// never got to `take`: newer ones were there before, or the network lost them. Nothing where
  /// messages have no numbers (ROS 1). Those that were lost last are known with the next that
  /// comes, or after a second without one. What is heard of is looked at here: while nothing comes,
  /// it is to be asked from time to time.
  virtual std::optional<std::uint64_t> lost() const { return std::nullopt; }
  /// Packets that this process has lost since its start because its receive buffers were full. Over
  /// ROS 2 a message is lost with one of its packets unless it is sent reliably.
  virtual std::uint64_t dropped_packets() const { return 0; }
  /// Quality of service that publishers of this topic offer and this subscriber cannot take, as
  /// RawPublisher::misfit().
  virtual std::string misfit() const { return {}; }
  /// True if its publishers send their newest message to late subscribers, so that a publisher that
  /// is silent has nothing new.
  virtual bool latched() const { return false; }
};

/// What a topic carries in place of what was subscribed to.
struct OtherType {
  std::string type;  ///< the topic's; empty: another version of ours
  std::string text;  ///< "topic '/scan' carries geometry_msgs/Twist, not sensor_msgs/LaserScan"
  /// Name of the publisher's node. Empty as long as it is unknown: over ROS 2 it arrives some
  /// milliseconds after the type.
  std::function<std::string()> node{};
};

OtherType other_type(const std::string& topic, const std::string& type, const std::string& wanted,
                     std::function<std::string()> node = {});

/// How to use the other type: "write  message: geometry_msgs/TwistStamped ...".
std::string remedy_for_type(const std::string& type, const std::string& wanted);

/// A subscriber of another node.
struct Partner {
  std::string node;  ///< "/base"; empty if unknown
  std::string type;  ///< "geometry_msgs/Twist"
};

struct Subscription {
  std::string topic;
  std::string message_type;  ///< "sensor_msgs/LaserScan"
  /// Messages that may wait for the session's thread; of more, the oldest are lost. 1: the newest
  /// alone; 0: any number. ROS 2: with 0, what the network loses is sent again, unless the
  /// publisher is best effort.
  std::uint32_t queue = 1;
  /// ROS 2: what a reliable publisher sends and the network loses is sent again, also with another
  /// queue than 0. For messages of many packets, which seldom arrive whole otherwise. Those behind
  /// a lost one wait for it, and a publisher may wait for a process that is stopped: not for small
  /// messages whose next one is better than a late one.
  bool reliable = false;
  /// Also what was published before. ROS 2: as long as all publishers of the topic offer it
  /// (transient local); ROS 1 sends it to every subscriber.
  bool latched = false;
  /// Called in a thread of the session the moment a message of this type has arrived; the bytes are
  /// valid until it returns. Must not throw.
  std::function<void(std::span<const std::byte> message)> take;
  /// Told when the topic carries another type, or another version of this one; may come again.
  /// Called in a thread of the session; must not throw. May be empty.
  std::function<void(const OtherType& other)> refuse{};
};

/// Where nodes meet, as variables of the environment say it: of ROS 1 ROS_MASTER_URI, of ROS 2
/// ROS_DOMAIN_ID and those that say how far it looks for others.
using Place = std::map<std::string, std::string>;

struct SessionSettings {
  std::string node_name;
  /// ROS 1, whose master ends the first of two nodes with a name: adds a suffix of its own to it.
  bool unique_name = false;
  RosArguments arguments{};  ///< `__name` wins over `node_name`
  Place place{};             ///< another session's; empty: what this process's environment says
  bool warn_of_unreachable_nodes = true;  ///< ROS 1: and of other types
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
  /// False once ROS has shut the node down: nothing comes and nothing leaves any more.
  virtual bool alive() const = 0;
  /// @throws TransportError that says why when it is not alive.
  virtual void require_alive() const = 0;
  /// Takes leave of the other nodes, for a process that ends without coming to its end: they need
  /// not wait until they miss it. From any thread; nothing comes and nothing leaves any more. Takes
  /// 300 ms at most. Does nothing over ROS 1 and by rclcpp.
  virtual void leave() {}
  /// Whether its topics stay inside this process: no other program hears or stops a robot on them.
  virtual bool local() const { return false; }
  /// With it another process meets the nodes that this one meets.
  virtual Place place() const = 0;
  /// "/scan" of "scan": with the namespace and what has been remapped.
  virtual std::string whole_topic(const std::string& topic) const = 0;

  /// @param latched what was published last also goes to those that subscribe later (ROS 2: as many
  /// messages as the queue holds, to subscribers that ask for it by transient local)
  /// @throws ConfigurationError for an unknown type or an impossible topic.
  virtual std::unique_ptr<RawPublisher> publisher(const std::string& topic,
                                                  const std::string& message_type,
                                                  std::uint32_t queue = 10,
                                                  bool latched = false) = 0;
  /// @throws ConfigurationError for an unknown type or an impossible topic.
  virtual std::unique_ptr<RawSubscriber> subscriber(Subscription subscription) = 0;
  /// Whether anybody publishes a topic, as far as ROS 1's master, or ROS 2's discovery, knows by
  /// now.
  /// @param topic as whole_topic() gives it
  virtual bool has_publishers(const std::string& topic) const = 0;
  /// Subscribers of a topic, of any type, as far as they are known; over ROS 1 only those of
  /// another type than the publisher's. Never waits.
  /// @param topic as whole_topic() gives it
  virtual std::vector<Partner> subscribers(const std::string& /*topic*/) const { return {}; }
  /// Whether a topic has publishers, and each of them counts this node among its subscribers: what
  /// they publish from now on comes.
  /// @param topic as whole_topic() gives it
  virtual bool publishers_know_us(const std::string& topic) const = 0;
  /// True if a warning has named a node of this topic that cannot be connected, or a wrong address
  /// of this node, or if that is being examined (ROS 1). Then there is no need to warn that the
  /// topic brings no messages, or has no subscribers.
  /// @param topic as whole_topic() gives it
  virtual bool has_warned_of_unreachable_node(const std::string& /*topic*/) const { return false; }
};

}  // namespace spikeloop::topics
