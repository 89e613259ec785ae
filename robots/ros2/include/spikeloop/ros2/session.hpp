// This process as a ROS 2 node, over Cyclone DDS; no ROS 2 is installed.
#pragma once

#include <memory>
#include <string>

#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros2 {

/// May be made more than once in a process: each is a node of its own, and they meet as two
/// processes do. Installs no signal handler; its threads block all signals.
///
/// Publishers are reliable and volatile, so that every subscriber of ROS 2 matches them.
/// Subscribers are best effort and volatile, so that every publisher does; with `queue` 0 they are
/// reliable: every message comes. Other readers are added for publishers that offer more, or less
/// (Level). A publisher's queue bounds what it keeps for a slow subscriber that is reliable; 0:
/// everything.
class Session final : public topics::Session {
 public:
  /// `settings.place` and the environment: see discovery::parse(); `settings.arguments`: names of
  /// topics,
  /// `__name` and `__ns`.
  /// @throws ConfigurationError for an impossible name, topic or value of a variable,
  /// TransportError when Cyclone DDS does not start, with what it says.
  explicit Session(const topics::SessionSettings& settings);
  ~Session() override;

  messages::Dialect dialect() const override { return messages::Dialect::ros2; }
  std::string node_name() const override;
  bool alive() const override { return true; }  ///< nobody but this process ends a node of ROS 2
  void require_alive() const override {}
  void leave() override;
  topics::Place place() const override;
  std::string whole_topic(const std::string& topic) const override;

  std::unique_ptr<topics::RawPublisher> publisher(const std::string& topic,
                                                  const std::string& message_type,
                                                  std::uint32_t queue = 10,
                                                  bool latched = false) override;
  std::unique_ptr<topics::RawSubscriber> subscriber(topics::Subscription subscription) override;
  bool has_publishers(const std::string& topic) const override;
  std::vector<topics::Partner> subscribers(const std::string& topic) const override;
  bool publishers_are_connected(const std::string& topic) const override;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::ros2
