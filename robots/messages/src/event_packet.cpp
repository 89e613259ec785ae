#include "spikeloop/messages/event_packet.hpp"

#include "header.hpp"

namespace spikeloop::messages {

EventPacket read_event_packet(Dialect dialect, std::span<const std::byte> message) {
  return with_reader(dialect, message, [&](auto& reader) {
    skip_header(reader, dialect);
    EventPacket packet;
    packet.height = read_uint32(reader);
    packet.width = read_uint32(reader);
    packet.sequence = read_uint64(reader);
    packet.time_base = read_uint64(reader);
    packet.encoding = reader.text();
    packet.big_endian = reader.number(Primitive::boolean) != 0;
    packet.events = read_bytes(reader);
    return packet;
  });
}

}  // namespace spikeloop::messages
