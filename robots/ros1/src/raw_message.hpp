// A message of any type as bytes, with the traits that roscpp requires.
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace spikeloop::ros1 {

struct RawMessage {
  std::vector<std::byte> bytes;
};

}  // namespace spikeloop::ros1

namespace ros::message_traits {

// "*": any type. The type of a topic is given when it is advertised or subscribed.
template <>
struct MD5Sum<spikeloop::ros1::RawMessage> {
  static const char* value() { return "*"; }
  static const char* value(const spikeloop::ros1::RawMessage&) { return "*"; }
};
template <>
struct DataType<spikeloop::ros1::RawMessage> {
  static const char* value() { return "*"; }
  static const char* value(const spikeloop::ros1::RawMessage&) { return "*"; }
};
template <>
struct Definition<spikeloop::ros1::RawMessage> {
  static const char* value() { return ""; }
  static const char* value(const spikeloop::ros1::RawMessage&) { return ""; }
};

}  // namespace ros::message_traits

namespace ros::serialization {

template <>
struct Serializer<spikeloop::ros1::RawMessage> {
  template <typename Stream>
  static void write(Stream& stream, const spikeloop::ros1::RawMessage& message) {
    const std::uint32_t size = serializedLength(message);
    std::copy_n(reinterpret_cast<const std::uint8_t*>(message.bytes.data()), size,
                stream.advance(size));
  }
  template <typename Stream>
  static void read(Stream& stream, spikeloop::ros1::RawMessage& message) {
    const std::uint32_t size = stream.getLength();
    const auto* const begin = reinterpret_cast<const std::byte*>(stream.advance(size));
    message.bytes.assign(begin, begin + size);
  }
  static std::uint32_t serializedLength(const spikeloop::ros1::RawMessage& message) {
    return static_cast<std::uint32_t>(message.bytes.size());
  }
};

}  // namespace ros::serialization
