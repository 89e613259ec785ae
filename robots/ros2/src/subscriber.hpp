// A topic in over DDS.
#pragma once

#include <atomic>

#include "raw_type.hpp"
#include "session_impl.hpp"

namespace spikeloop::ros2 {

class Subscriber final : public topics::RawSubscriber {
 public:
  /// @throws TransportError when Cyclone DDS refuses it.
  Subscriber(Session::Impl& session, const Endpoint& endpoint, topics::Subscription subscription);
  ~Subscriber() override;

  bool has_publishers() const override;

 private:
  void take_some();
  void take(std::span<const std::byte> message);
  void look_at(const Writer& writer);
  void refuse(const topics::OtherType& other);

  Session::Impl& session_;
  Endpoint endpoint_;
  topics::Subscription subscription_;
  RawTopic topic_;
  dds_entity_t reader_;
  dds_entity_t arrived_;  ///< a read condition
  bool complained_ = false;
  Dispatcher::Ticket ticket_ = 0;
  Graph::Listener listener_ = 0;
};

}  // namespace spikeloop::ros2
