#include "spikeloop/ros1/raw_subscriber.hpp"

#include <mutex>
#include <utility>

#include "raw_message.hpp"
#include "session_impl.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::ros1 {
namespace {

/// roscpp shares it: after a shutdown of ROS, unsubscribing waits for no callback.
struct Receiver {
  void take(const RawMessage& message) {
    const std::lock_guard lock(mutex);
    if (callback) {
      callback(message.bytes);
    }
  }
  void close() {
    const std::lock_guard lock(mutex);
    callback = nullptr;
  }

  std::mutex mutex;
  RawSubscriber::Callback callback;
};

}  // namespace

struct RawSubscriber::Impl {
  std::shared_ptr<Receiver> receiver = std::make_shared<Receiver>();
  ros::Subscriber subscriber;
};

RawSubscriber::RawSubscriber(Session& session, const std::string& topic,
                             const std::string& message_type, Callback callback,
                             std::uint32_t queue)
    : impl_(std::make_unique<Impl>()) {
  check_topic(topic);
  impl_->receiver->callback = std::move(callback);
  ros::SubscribeOptions options;
  options.init<RawMessage>(
      topic, queue,
      [receiver = impl_->receiver](const boost::shared_ptr<const RawMessage>& message) {
        receiver->take(*message);
      });
  const auto& catalog = messages::Catalog::for_type(messages::Dialect::ros1, message_type);
  options.datatype = catalog.full_name(message_type);
  options.md5sum = catalog.md5(options.datatype);
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  impl_->subscriber = session.impl().node->subscribe(options);
}

RawSubscriber::~RawSubscriber() {
  impl_->subscriber.shutdown();
  impl_->receiver->close();
}

bool RawSubscriber::has_publishers() const {
  return impl_->subscriber.getNumPublishers() != 0;
}

}  // namespace spikeloop::ros1
