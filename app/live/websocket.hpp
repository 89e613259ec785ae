// The WebSocket protocol as a server uses it (RFC 6455). Pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace spikeloop::view {

/// Value of the header Sec-WebSocket-Accept for the client's Sec-WebSocket-Key (4.2.2).
std::string accept_key(std::string_view client_key);

enum class Opcode : unsigned char {
  continuation = 0,
  text = 1,
  binary = 2,
  close = 8,
  ping = 9,
  pong = 10
};

/// Reasons to end a connection (7.4.1).
enum class CloseCode : std::uint16_t {
  normal = 1000,
  protocol_error = 1002,
  violated_policy = 1008,
  too_big = 1009
};

/// Header of a whole, unmasked message of this many bytes.
std::string frame_header(Opcode opcode, std::size_t size);
std::string close_frame(CloseCode code);

struct IncomingFrame {
  bool last = false;  ///< false: the message continues in another frame
  Opcode opcode{};
  std::string_view payload;  ///< view into the input
  std::size_t size = 0;      ///< bytes of the frame with its header
};

struct ParsedFrame {
  std::optional<IncomingFrame> frame{};
  std::optional<CloseCode> error{};
};

/// Reads the first frame of the input and unmasks it in place. Neither frame nor error: the frame
/// is not complete. An unmasked frame, an unknown opcode and a reserved bit are errors, and so is a
/// payload of more than `limit` bytes, as soon as the header is complete.
ParsedFrame parse_frame(std::span<char> input, std::size_t limit);

}  // namespace spikeloop::view
