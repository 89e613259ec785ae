// event_camera_msgs/EventPacket: an event camera's messages, still as the camera packed them.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "spikeloop/messages/dialect.hpp"
#include "spikeloop/messages/event_decoder.hpp"

namespace spikeloop::messages {

inline constexpr std::string_view kEventPacket = "event_camera_msgs/EventPacket";

/// A view of the message's bytes. @throws TransportError when they end too early.
EventPacket read_event_packet(Dialect dialect, std::span<const std::byte> message);

}  // namespace spikeloop::messages
