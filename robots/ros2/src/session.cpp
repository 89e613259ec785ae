#include "spikeloop/ros2/session.hpp"

#include <fmt/format.h>

#include <chrono>
#include <future>
#include <memory>
#include <thread>
#include <utility>

#include "publisher.hpp"
#include "session_impl.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/topics/blocked_signals.hpp"
#include "subscriber.hpp"

namespace spikeloop::ros2 {
namespace {

constexpr std::chrono::milliseconds kLongestLeave{300};

discovery::Variables place_of(const topics::SessionSettings& settings) {
  return settings.place.empty() ? discovery::environment() : settings.place;
}

}  // namespace

Session::Impl::Impl(const topics::SessionSettings& settings)
    : place(place_of(settings)),
      found(discovery::parse(place)),
      node(node_identity(settings.node_name, settings.arguments)),
      names(node, settings.arguments),
      domain(found),
      participant(domain, found),
      dispatcher(participant.entity()),
      graph(participant.entity(), dispatcher),
      node_topic(participant.entity(), NodeList::kTopic, NodeList::kType),
      nodes(participant.entity(), node_topic, graph, dispatcher, node, found.distribution),
      acquaintance(participant.entity(), node_topic, graph) {
  place["ROS_DOMAIN_ID"] = fmt::to_string(found.domain);
}

Endpoint endpoint(const Session::Impl& session, const std::string& topic,
                  const std::string& message_type) {
  const messages::Catalog& catalog =
      messages::Catalog::for_type(messages::Dialect::ros2, message_type);
  const std::string type = catalog.full_name(message_type);
  Endpoint result{.topic = session.names.whole(topic),
                  .message_type = type,
                  .user_data = fmt::format("typehash={};", catalog.type_hash(type))};
  dds_topic(result.topic);  // not too long?
  return result;
}

Session::Session(const topics::SessionSettings& settings) {
  const topics::BlockedSignals blocked;
  impl_ = std::make_unique<Impl>(settings);
}

Session::~Session() = default;

std::string Session::node_name() const {
  return impl_->node.whole();
}

/// In a thread of its own: a writer waits for its subscribers when it is deleted. The whole domain:
/// Cyclone tells other processes from a thread of its own, and only a domain's deletion waits for
/// it.
void Session::leave() {
  impl_->left = true;
  const auto done = std::make_shared<std::promise<void>>();
  const auto end = done->get_future();
  std::thread([this, done] {
    impl_->dispatcher.stop();
    dds_delete(impl_->domain.entity());
    done->set_value();
  }).detach();
  end.wait_for(kLongestLeave);
}

topics::Place Session::place() const {
  return impl_->place;
}

std::string Session::whole_topic(const std::string& topic) const {
  return impl_->names.whole(topic);
}

std::unique_ptr<topics::RawPublisher> Session::publisher(const std::string& topic,
                                                         const std::string& message_type,
                                                         std::uint32_t queue, bool latched) {
  return std::make_unique<Publisher>(*impl_, endpoint(*impl_, topic, message_type), queue, latched);
}

std::unique_ptr<topics::RawSubscriber> Session::subscriber(topics::Subscription subscription) {
  const Endpoint where = endpoint(*impl_, subscription.topic, subscription.message_type);
  return std::make_unique<Subscriber>(*impl_, where, std::move(subscription));
}

bool Session::has_publishers(const std::string& topic) const {
  return !impl_->graph.writers(dds_topic(topic)).empty();
}

std::vector<topics::Partner> Session::subscribers(const std::string& topic) const {
  std::vector<topics::Partner> partners;
  for (const OtherReader& reader : impl_->graph.readers(dds_topic(topic))) {
    partners.push_back({.node = impl_->nodes.node_of(reader.guid), .type = ros_type(reader.type)});
  }
  return partners;
}

bool Session::publishers_are_connected(const std::string& topic) const {
  return !impl_->left && impl_->acquaintance.with_publishers(dds_topic(topic));
}

}  // namespace spikeloop::ros2
