// Bytes with the name of their type, as rosbag wants a message.
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>

namespace spikeloop::bag {

struct MessageType {
  std::string name;
  std::string md5;
  std::string definition;
};

struct RawMessage {
  const MessageType& type;
  std::span<const std::byte> bytes;
};

}  // namespace spikeloop::bag

namespace ros::message_traits {

template <>
struct MD5Sum<spikeloop::bag::RawMessage> {
  static const char* value(const spikeloop::bag::RawMessage& message) {
    return message.type.md5.c_str();
  }
};
template <>
struct DataType<spikeloop::bag::RawMessage> {
  static const char* value(const spikeloop::bag::RawMessage& message) {
    return message.type.name.c_str();
  }
};
template <>
struct Definition<spikeloop::bag::RawMessage> {
  static const char* value(const spikeloop::bag::RawMessage& message) {
    return message.type.definition.c_str();
  }
};

}  // namespace ros::message_traits

namespace ros::serialization {

template <>
struct Serializer<spikeloop::bag::RawMessage> {
  template <typename Stream>
  static void write(Stream& stream, const spikeloop::bag::RawMessage& message) {
    const std::uint32_t size = serializedLength(message);
    std::copy_n(reinterpret_cast<const std::uint8_t*>(message.bytes.data()), size,
                stream.advance(size));
  }
  static std::uint32_t serializedLength(const spikeloop::bag::RawMessage& message) {
    return static_cast<std::uint32_t>(message.bytes.size());
  }
};

}  // namespace ros::serialization
