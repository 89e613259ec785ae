// std_msgs/Header, for the readers that do not go by a message's definition.
#pragma once

#include <cstdint>

#include "spikeloop/messages/dialect.hpp"
#include "wire.hpp"

namespace spikeloop::messages {

template <typename Reader>
void skip_header(Reader& reader, Dialect dialect) {
  if (dialect == Dialect::ros1) {
    reader.number(Primitive::uint32);  // seq
  }
  reader.number(Primitive::time);
  reader.text();
}

template <typename Reader>
std::uint32_t read_uint32(Reader& reader) {
  return static_cast<std::uint32_t>(reader.number(Primitive::uint32));
}

/// Reads a number from an array of bytes.
template <typename T>
T load(const std::byte* at, bool big_endian) {
  std::byte bytes[sizeof(T)];
  std::memcpy(bytes, at, sizeof(T));
  if (big_endian) {
    std::reverse(std::begin(bytes), std::end(bytes));
  }
  T value{};
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// Every digit of it, which a double does not have.
template <typename Reader>
std::uint64_t read_uint64(Reader& reader) {
  std::uint64_t value = 0;
  reader.align(sizeof value);
  std::memcpy(&value, reader.take_bytes(sizeof value).data(), sizeof value);
  return value;
}

/// A uint8[].
template <typename Reader>
std::span<const std::byte> read_bytes(Reader& reader) {
  return reader.take_bytes(reader.length(1));
}

}  // namespace spikeloop::messages
