// Qualities of service as ROS 2 has them.
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <memory>
#include <string>

namespace spikeloop::ros2 {

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

/// Defaults, and this as user data unless it is empty.
Qos user_data_qos(const std::string& user_data);

/// Of a publisher: reliable, the newest `queue` messages (0: all) kept for reliable subscribers.
/// @param latched kept for those that come later, too (ROS 2: transient local)
Qos writer_qos(std::uint32_t queue, bool latched, const std::string& user_data);

/// Of a subscriber: the newest `queue` messages, 0: all. Not reliable: best effort, for any
/// publisher.
Qos reader_qos(std::uint32_t queue, bool reliable, bool latched, const std::string& user_data);

/// Quality of service that a subscriber requests and the publisher does not offer, for messages: "a
/// deadline of 100 ms, but Spikeloop's publisher has none".
struct Requests {
  std::string late{};   ///< durability; met by publishers that are latched
  std::string other{};  ///< met by no publisher of ours
};
Requests requests_of(const dds_qos_t* qos);
/// What a publisher offers and no subscriber of ours takes, for messages; empty if nothing.
std::string offer_misfit(const dds_qos_t* qos);

bool is_reliable(const dds_qos_t* qos);
/// True if a late subscriber receives what was published before: reliable, and transient local or
/// more.
bool is_latched(const dds_qos_t* qos);

}  // namespace spikeloop::ros2
