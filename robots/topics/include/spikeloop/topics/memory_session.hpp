// Topics inside one process: of a robot that is part of the experiment's process, and of a bag.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "spikeloop/topics/session.hpp"

namespace spikeloop::topics {

/// A message goes to its subscribers in the thread that publishes it, in the order of their
/// subscriptions, with its bytes. For one thread. Nothing is kept for later subscribers.
class MemorySession : public Session {
 public:
  explicit MemorySession(messages::Dialect dialect = messages::Dialect::ros1) : dialect_(dialect) {}

  messages::Dialect dialect() const override { return dialect_; }
  std::string node_name() const override { return "/spikeloop"; }
  bool alive() const override { return true; }
  void require_alive() const override {}
  Place place() const override { return {}; }
  bool local() const override { return true; }
  std::string whole_topic(const std::string& topic) const override {
    return topic.starts_with('/') ? topic : "/" + topic;
  }

  std::unique_ptr<RawPublisher> publisher(const std::string& topic, const std::string& message_type,
                                          std::uint32_t queue = 10, bool latched = false) override;
  std::unique_ptr<RawSubscriber> subscriber(Subscription subscription) override;
  bool has_publishers(const std::string& topic) const override;
  bool publishers_know_us(const std::string& topic) const override { return has_publishers(topic); }

 private:
  struct Topic;
  class Publisher;
  class Subscriber;

  std::shared_ptr<Topic> topic(const std::string& name);

  messages::Dialect dialect_;
  std::map<std::string, std::shared_ptr<Topic>> topics_;  ///< by their whole names
};

}  // namespace spikeloop::topics
