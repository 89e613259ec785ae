// This process as a ROS 1 node.
#pragma once

#include <memory>
#include <string>

#include "spikeloop/core/time.hpp"
#include "spikeloop/ros1/arguments.hpp"

namespace spikeloop::ros1 {

struct SessionSettings {
  std::string node_name;
  /// Adds a suffix of its own to the name: ROS 1 ends the older one of two nodes with the same
  /// name.
  bool unique_name = false;
  std::string master_uri{};  ///< empty: as master_uri() says
  TimeNs master_timeout = 5 * kNsPerSecond;
  RosArguments arguments{};  ///< `__name` wins over `node_name`
};

/// Once a process: roscpp knows but one node. Its callbacks run in a thread of their own. Installs
/// no signal handler. Block the signals you wait for before: roscpp starts threads.
class Session {
 public:
  /// @throws TransportError without a master (see require_master), ConfigurationError for an
  /// impossible name of a node or in the arguments, std::logic_error the second time.
  explicit Session(const SessionSettings& settings);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  std::string node_name() const;  ///< "/ros_command_node_1700000000000000000"
  /// False once ROS has shut the node down, as it does when another one takes its name.
  bool alive() const;
  /// @throws TransportError once it is not alive: nothing comes and nothing leaves any more.
  void require_alive() const;

  struct Impl;
  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// @throws ConfigurationError when roscpp would refuse the name.
void check_node_name(const std::string& name);
void check_topic(const std::string& topic);
/// "/scan" of "scan", as ROS resolves it once there is a session.
std::string whole_topic(const std::string& topic);

}  // namespace spikeloop::ros1
