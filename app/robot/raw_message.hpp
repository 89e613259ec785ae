// A message of any type as bytes, as roscpp wants it.
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>

#include <cstddef>
#include <cstring>
#include <vector>

namespace spikeloop::robot {

struct RawMessage {
  std::vector<std::byte> bytes;
};

}  // namespace spikeloop::robot

namespace ros::message_traits {

// "*": any type; the topic's own is given where it is advertised or subscribed.
template <>
struct MD5Sum<spikeloop::robot::RawMessage> {
  static const char* value() { return "*"; }
  static const char* value(const spikeloop::robot::RawMessage&) { return "*"; }
};
template <>
struct DataType<spikeloop::robot::RawMessage> {
  static const char* value() { return "*"; }
  static const char* value(const spikeloop::robot::RawMessage&) { return "*"; }
};
template <>
struct Definition<spikeloop::robot::RawMessage> {
  static const char* value() { return ""; }
  static const char* value(const spikeloop::robot::RawMessage&) { return ""; }
};

}  // namespace ros::message_traits

namespace ros::serialization {

template <>
struct Serializer<spikeloop::robot::RawMessage> {
  template <typename Stream>
  static void write(Stream& stream, const spikeloop::robot::RawMessage& message) {
    const auto size = static_cast<std::uint32_t>(message.bytes.size());
    std::memcpy(stream.advance(size), message.bytes.data(), size);
  }
  template <typename Stream>
  static void read(Stream& stream, spikeloop::robot::RawMessage& message) {
    const std::uint32_t size = stream.getLength();
    message.bytes.resize(size);
    std::memcpy(message.bytes.data(), stream.advance(size), size);
  }
  static std::uint32_t serializedLength(const spikeloop::robot::RawMessage& message) {
    return static_cast<std::uint32_t>(message.bytes.size());
  }
};

}  // namespace ros::serialization
