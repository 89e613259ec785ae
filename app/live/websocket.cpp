#include "websocket.hpp"

// <sha1.h> needs these types, but does not include them.
#include <sys/types.h>

#include <sha1.h>

#include <array>

namespace spikeloop::view {
namespace {

constexpr std::size_t kShortPayload = 125;  // largest size in the second byte of a header
constexpr unsigned char kSize16 = 126;      // the size is in the next two bytes
constexpr unsigned char kSize64 = 127;      // the size is in the next eight bytes
constexpr unsigned char kLast = 0x80;
constexpr unsigned char kReserved = 0x70;
constexpr unsigned char kMasked = 0x80;
constexpr std::size_t kMaskBytes = 4;
constexpr unsigned kByte = 8;  // bits

void append_big_endian(std::string& text, std::uint64_t value, std::size_t bytes) {
  for (std::size_t i = bytes; i-- > 0;) {
    text += static_cast<char>(value >> (kByte * i));
  }
}

std::uint64_t big_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (const char byte : bytes) {
    value = value << kByte | static_cast<unsigned char>(byte);
  }
  return value;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::string_view group = bytes.substr(at, 3);
    const std::uint64_t value = big_endian(group) << (kByte * (3 - group.size()));
    for (std::size_t digit = 0; digit < 4; ++digit) {
      text += digit <= group.size() ? kDigits[value >> (6 * (3 - digit)) & 63] : '=';
    }
  }
  return text;
}

bool is_known(Opcode opcode) {
  return opcode <= Opcode::binary || (opcode >= Opcode::close && opcode <= Opcode::pong);
}

}  // namespace

std::string accept_key(std::string_view client_key) {
  const std::string text = std::string(client_key) + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";
  SHA1_CTX hash;
  SHA1Init(&hash);
  SHA1Update(&hash, reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  std::array<std::uint8_t, SHA1_DIGEST_LENGTH> digest{};
  SHA1Final(digest.data(), &hash);
  return base64(std::string(digest.begin(), digest.end()));
}

std::string frame_header(Opcode opcode, std::size_t size) {
  std::string header(1, static_cast<char>(kLast | static_cast<unsigned char>(opcode)));
  if (size <= kShortPayload) {
    header += static_cast<char>(size);
  } else if (size <= UINT16_MAX) {
    header += static_cast<char>(kSize16);
    append_big_endian(header, size, 2);
  } else {
    header += static_cast<char>(kSize64);
    append_big_endian(header, size, 8);
  }
  return header;
}

std::string close_frame(CloseCode code) {
  std::string frame = frame_header(Opcode::close, 2);
  append_big_endian(frame, static_cast<std::uint16_t>(code), 2);
  return frame;
}

ParsedFrame parse_frame(std::span<char> input, std::size_t limit) {
  const std::string_view bytes(input.data(), input.size());
  if (bytes.size() < 2) {
    return {};
  }
  const auto first = static_cast<unsigned char>(bytes[0]);
  const auto second = static_cast<unsigned char>(bytes[1]);
  const auto opcode = static_cast<Opcode>(first & 0x0f);
  const auto short_size = static_cast<unsigned char>(second & ~kMasked);
  const bool is_control = opcode >= Opcode::close;
  if ((first & kReserved) != 0 || !is_known(opcode) || (second & kMasked) == 0 ||
      (is_control && ((first & kLast) == 0 || short_size > kShortPayload))) {
    return {.error = CloseCode::protocol_error};
  }
  const std::size_t size_bytes = short_size == kSize16 ? 2 : short_size == kSize64 ? 8 : 0;
  const std::size_t header = 2 + size_bytes + kMaskBytes;
  if (bytes.size() < 2 + size_bytes) {
    return {};
  }
  const std::uint64_t size = size_bytes == 0 ? short_size : big_endian(bytes.substr(2, size_bytes));
  if (size > limit) {
    return {.error = CloseCode::too_big};
  }
  if (bytes.size() < header + size) {
    return {};
  }
  for (std::size_t i = 0; i < size; ++i) {
    input[header + i] =
        static_cast<char>(input[header + i] ^ input[header - kMaskBytes + i % kMaskBytes]);
  }
  return {.frame = IncomingFrame{(first & kLast) != 0, opcode, bytes.substr(header, size),
                                 header + size}};
}

}  // namespace spikeloop::view
