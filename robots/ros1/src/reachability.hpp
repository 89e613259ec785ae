// Warnings about nodes that the master lists and that cannot be connected.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "raw_subscriber.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros1 {

/// roscpp retries a connection without a message and without end if the host name of a node does
/// not resolve or the node does not answer, and drops it without a message if the node has another
/// type. Nodes cannot connect to this one either if it registers a wrong address (ROS_HOSTNAME,
/// ROS_IP). A thread compares the connections of all topics of this process with those that the
/// master lists. It logs one warning per node and topic that cannot be connected, and reports other
/// types.
class ReachabilityWatch {
 public:
  /// @param master_uri URI of a master that has answered
  explicit ReachabilityWatch(const std::string& master_uri);
  /// Does not wait for a host name that is being resolved.
  ~ReachabilityWatch();
  ReachabilityWatch(const ReachabilityWatch&) = delete;
  ReachabilityWatch& operator=(const ReachabilityWatch&) = delete;

  /// Compares the types of a topic's publishers with that of this subscription.
  void add(const std::shared_ptr<Receiver>& receiver);
  /// As Session::has_warned_of_unreachable_node. Safe to call from any thread.
  bool has_warned_of(const std::string& topic) const;
  /// Subscribers of another type than this node publishes. Safe to call from any thread.
  std::vector<topics::Partner> refused_subscribers(const std::string& topic) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::ros1
