// This process as a ROS 1 node.
#pragma once

#include <memory>
#include <string>

#include "spikeloop/core/time.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros1 {

struct SessionSettings : topics::SessionSettings {
  TimeNs master_timeout = 5 * kNsPerSecond;  ///< longest wait for the master
};

/// URI of the master in `settings.place`, else that of master_uri().
std::string master_of(const SessionSettings& settings);

/// One per process, because roscpp supports one node only. Callbacks run in a separate thread.
/// Installs no signal handler. Block signals for which the program waits before the construction,
/// because roscpp starts threads.
///
/// ROS 1 ends the older one of two nodes with the same name. Topics use TCP_NODELAY on both sides.
/// roscpp sets the sequence number of messages that begin with a header.
class Session : public topics::Session {
 public:
  /// @throws TransportError without a master (see require_master), ConfigurationError for an
  /// invalid name of a node or an invalid argument, std::logic_error at the second construction.
  explicit Session(const SessionSettings& settings);
  ~Session() override;

  messages::Dialect dialect() const override { return messages::Dialect::ros1; }
  std::string node_name() const override;
  bool alive() const override;
  void require_alive() const override;
  topics::Place place() const override;
  std::string whole_topic(const std::string& topic) const override;

  /// @param queue messages that may wait for roscpp's thread. If there are more, the oldest are
  /// lost. 0: unlimited
  std::unique_ptr<topics::RawPublisher> publisher(const std::string& topic,
                                                  const std::string& message_type,
                                                  std::uint32_t queue = 10,
                                                  bool latched = false) override;
  /// roscpp does not connect publishers of another type. They are reported within 0.5 s in the
  /// first 5 s of a subscription, and later within 4 s.
  std::unique_ptr<topics::RawSubscriber> subscriber(topics::Subscription subscription) override;
  bool has_publishers(const std::string& topic) const override;
  /// Lists subscribers of another type, which roscpp does not connect.
  std::vector<topics::Partner> subscribers(const std::string& topic) const override;
  /// Requests the connections of the master and the publishers, which takes milliseconds. roscpp's
  /// subscriber lists a connection before the publisher has accepted it.
  bool publishers_are_connected(const std::string& topic) const override;
  bool has_warned_of_unreachable_node(const std::string& topic) const override;
  bool is_connected_to_publisher(const std::string& topic) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::ros1
