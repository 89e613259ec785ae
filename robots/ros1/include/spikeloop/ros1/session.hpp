// This process as a ROS 1 node.
#pragma once

#include <memory>
#include <string>

#include "spikeloop/core/time.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros1 {

struct SessionSettings : topics::SessionSettings {
  TimeNs master_timeout = 5 * kNsPerSecond;  ///< how long to wait for the master
};

/// The URI in the settings' place, or what master_uri() says.
std::string master_of(const SessionSettings& settings);

/// Once a process: roscpp knows but one node. Its callbacks run in a thread of their own. Installs
/// no signal handler. Block the signals you wait for before: roscpp starts threads.
///
/// ROS 1 ends the older one of two nodes with the same name. Topics have TCP_NODELAY on both sides.
/// roscpp numbers the messages of a type that begins with a header.
class Session : public topics::Session {
 public:
  /// @throws TransportError without a master (see require_master), ConfigurationError for an
  /// impossible name of a node or in the arguments, std::logic_error the second time.
  explicit Session(const SessionSettings& settings);
  ~Session() override;

  messages::Dialect dialect() const override { return messages::Dialect::ros1; }
  std::string node_name() const override;
  bool alive() const override;
  void require_alive() const override;
  topics::Place place() const override;
  std::string whole_topic(const std::string& topic) const override;

  /// @param queue messages that may wait for roscpp's thread; of more, the oldest are lost; 0: any
  /// number
  std::unique_ptr<topics::RawPublisher> publisher(const std::string& topic,
                                                  const std::string& message_type,
                                                  std::uint32_t queue = 10,
                                                  bool latched = false) override;
  /// roscpp connects no publisher of another type. Such publishers are reported within 0.5 s in the
  /// first 5 s of a subscription, and later within 4 s.
  std::unique_ptr<topics::RawSubscriber> subscriber(topics::Subscription subscription) override;
  bool has_publishers(const std::string& topic) const override;
  /// Those of another type: roscpp does not connect them.
  std::vector<topics::Partner> subscribers(const std::string& topic) const override;
  /// Asks the master and the publishers, which takes milliseconds. A subscriber itself believes so
  /// some time before.
  bool publishers_know_us(const std::string& topic) const override;
  bool has_warned_of_unreachable_node(const std::string& topic) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::ros1
