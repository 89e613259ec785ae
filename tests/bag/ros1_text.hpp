// std_msgs/String for rosbag. The header of ROS 1 is no C++20.
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>

#include <string>

namespace spikeloop::test {

struct Ros1Text {
  std::string data;
};

}  // namespace spikeloop::test

namespace ros::message_traits {

template <>
struct MD5Sum<spikeloop::test::Ros1Text> {
  static const char* value(const spikeloop::test::Ros1Text&) {
    return "992ce8a1687cec8c8bd883ec73ca41d1";
  }
};
template <>
struct DataType<spikeloop::test::Ros1Text> {
  static const char* value(const spikeloop::test::Ros1Text&) { return "std_msgs/String"; }
};
template <>
struct Definition<spikeloop::test::Ros1Text> {
  static const char* value(const spikeloop::test::Ros1Text&) { return "string data\n"; }
};

}  // namespace ros::message_traits

namespace ros::serialization {

template <>
struct Serializer<spikeloop::test::Ros1Text> {
  template <typename Stream>
  static void write(Stream& stream, const spikeloop::test::Ros1Text& message) {
    stream.next(message.data);
  }
  static std::uint32_t serializedLength(const spikeloop::test::Ros1Text& message) {
    return static_cast<std::uint32_t>(4 + message.data.size());
  }
};

}  // namespace ros::serialization
