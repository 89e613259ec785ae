// Warnings about nodes that the master lists and that cannot be connected.
#pragma once

#include <memory>
#include <string>

namespace spikeloop::ros1 {

/// roscpp retries a connection silently and without end if the host name of a node does not resolve
/// or the node does not answer. Nodes cannot connect to this one either if it registers
/// a wrong address (ROS_HOSTNAME, ROS_IP). A thread compares the connections of all topics of this
/// process with those that the master lists, and logs one warning per node and topic.
class ReachabilityWatch {
 public:
  /// @param master_uri of the master, which has answered
  explicit ReachabilityWatch(const std::string& master_uri);
  /// Does not wait for a host name that is being resolved.
  ~ReachabilityWatch();
  ReachabilityWatch(const ReachabilityWatch&) = delete;
  ReachabilityWatch& operator=(const ReachabilityWatch&) = delete;

  /// True if a warning has named a node of this topic. Safe to call from any thread.
  bool has_warned(const std::string& topic) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::ros1
