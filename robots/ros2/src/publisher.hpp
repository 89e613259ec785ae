// A topic out over DDS.
#pragma once

#include <atomic>
#include <cstdint>

#include "raw_type.hpp"
#include "session_impl.hpp"

namespace spikeloop::ros2 {

class Publisher final : public topics::RawPublisher {
 public:
  /// @throws TransportError when Cyclone DDS refuses it.
  Publisher(Session::Impl& session, const Endpoint& endpoint, std::uint32_t queue, bool latched);
  ~Publisher() override;

  /// What leaves is with the system when this returns.
  void publish(std::span<const std::byte> message) override;
  bool has_subscribers() const override;
  std::string misfit() const override;
  void drain() const override { deliver(); }
  bool deliver() const override;

 private:
  Session::Impl& session_;
  std::string topic_name_;
  std::string dds_type_;
  bool latched_;
  RawTopic topic_;
  dds_entity_t writer_;
  std::atomic<bool> complained_{false};
};

}  // namespace spikeloop::ros2
