// Topics inside one process, for bags and for a robot in the process of the experiment.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "spikeloop/topics/session.hpp"

namespace spikeloop::topics {

/// publish() calls the subscribers in the order of their subscriptions, in the same thread. Not
/// thread-safe. Messages are not kept for later subscribers.
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
  bool publishers_are_connected(const std::string& topic) const override {
    return has_publishers(topic);
  }

 private:
  struct Topic;
  class Publisher;
  class Subscriber;

  std::shared_ptr<Topic> topic(const std::string& name);

  messages::Dialect dialect_;
  std::map<std::string, std::shared_ptr<Topic>> topics_;  ///< by full name
};

}  // namespace spikeloop::topics
