#include "spikeloop/topics/memory_session.hpp"

#include <list>
#include <utility>

#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::topics {
namespace {

std::string full_name(messages::Dialect dialect, const std::string& type) {
  return messages::Catalog::for_type(dialect, type).full_name(type);
}

}  // namespace

struct MemorySession::Topic {
  std::size_t publishers = 0;
  std::list<Subscription> subscribers;
};

class MemorySession::Publisher : public RawPublisher {
 public:
  Publisher(std::shared_ptr<Topic> topic, std::string type)
      : topic_(std::move(topic)), type_(std::move(type)) {
    ++topic_->publishers;
  }
  ~Publisher() override { --topic_->publishers; }

  void publish(std::span<const std::byte> message) override {
    for (const Subscription& subscriber : topic_->subscribers) {
      if (subscriber.message_type == type_) {
        subscriber.take(message);
      } else if (subscriber.refuse) {
        subscriber.refuse(other_type(subscriber.topic, type_, subscriber.message_type));
      }
    }
  }
  bool has_subscribers() const override { return !topic_->subscribers.empty(); }
  void drain() const override {}

 private:
  std::shared_ptr<Topic> topic_;
  std::string type_;
};

class MemorySession::Subscriber : public RawSubscriber {
 public:
  Subscriber(std::shared_ptr<Topic> topic, Subscription subscription)
      : topic_(std::move(topic)),
        place_(topic_->subscribers.insert(topic_->subscribers.end(), std::move(subscription))) {}
  ~Subscriber() override { topic_->subscribers.erase(place_); }

  bool has_publishers() const override { return topic_->publishers != 0; }

 private:
  std::shared_ptr<Topic> topic_;
  std::list<Subscription>::iterator place_;
};

std::shared_ptr<MemorySession::Topic> MemorySession::topic(const std::string& name) {
  auto& topic = topics_[whole_topic(name)];
  if (!topic) {
    topic = std::make_shared<Topic>();
  }
  return topic;
}

std::unique_ptr<RawPublisher> MemorySession::publisher(const std::string& topic,
                                                       const std::string& message_type,
                                                       std::uint32_t /*queue*/, bool /*latched*/) {
  return std::make_unique<Publisher>(this->topic(topic), full_name(dialect_, message_type));
}

std::unique_ptr<RawSubscriber> MemorySession::subscriber(Subscription subscription) {
  subscription.message_type = full_name(dialect_, subscription.message_type);
  auto topic = this->topic(subscription.topic);
  return std::make_unique<Subscriber>(std::move(topic), std::move(subscription));
}

bool MemorySession::has_publishers(const std::string& topic) const {
  const auto found = topics_.find(topic);
  return found != topics_.end() && found->second->publishers != 0;
}

}  // namespace spikeloop::topics
