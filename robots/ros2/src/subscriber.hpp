// A topic in over DDS.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>

#include "reader.hpp"
#include "session_impl.hpp"

namespace spikeloop::ros2 {

class Subscriber final : public topics::RawSubscriber {
 public:
  /// @throws TransportError when Cyclone DDS refuses it.
  Subscriber(Session::Impl& session, const Endpoint& endpoint, topics::Subscription subscription);
  ~Subscriber() override;

  bool has_publishers() const override;
  std::optional<std::uint64_t> lost() const override;

 private:
  void take(std::span<const std::byte> message);
  void look_at(const Writer& writer);
  void read_reliably(const Writer& writer);
  void refuse(const topics::OtherType& other);

  Session::Impl& session_;
  Endpoint endpoint_;
  topics::Subscription subscription_;
  RawTopic topic_;
  bool complained_ = false;
  mutable Reader reader_;  // it remembers what it has counted
  mutable std::mutex mutex_;
  /// For publishers that are best effort beside a reliable one, or the other way round.
  mutable std::optional<Reader> other_{};
  Graph::Listener listener_ = 0;
};

}  // namespace spikeloop::ros2
