// dvs_msgs as roscpp's generator would have made it: Debian has no package of it. C++17.
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <std_msgs/Header.h>

#include <cstdint>
#include <vector>

namespace dvs_msgs {

struct Event {
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  ros::Time ts;
  std::uint8_t polarity = 0;
};

struct EventArray {
  std_msgs::Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<Event> events;
};

}  // namespace dvs_msgs

namespace ros::message_traits {

template <>
struct MD5Sum<dvs_msgs::EventArray> {
  static const char* value() { return "5e8beee5a6c107e504c2e78903c224b8"; }
  static const char* value(const dvs_msgs::EventArray&) { return value(); }
};
template <>
struct DataType<dvs_msgs::EventArray> {
  static const char* value() { return "dvs_msgs/EventArray"; }
  static const char* value(const dvs_msgs::EventArray&) { return value(); }
};
template <>
struct Definition<dvs_msgs::EventArray> {
  static const char* value() {
    return "std_msgs/Header header\nuint32 height\nuint32 width\ndvs_msgs/Event[] events\n";
  }
  static const char* value(const dvs_msgs::EventArray&) { return value(); }
};

}  // namespace ros::message_traits

namespace ros::serialization {

template <>
struct Serializer<dvs_msgs::Event> {
  template <typename Stream, typename T>
  static void allInOne(Stream& stream, T message) {
    stream.next(message.x);
    stream.next(message.y);
    stream.next(message.ts);
    stream.next(message.polarity);
  }
  ROS_DECLARE_ALLINONE_SERIALIZER
};
template <>
struct Serializer<dvs_msgs::EventArray> {
  template <typename Stream, typename T>
  static void allInOne(Stream& stream, T message) {
    stream.next(message.header);
    stream.next(message.height);
    stream.next(message.width);
    stream.next(message.events);
  }
  ROS_DECLARE_ALLINONE_SERIALIZER
};

}  // namespace ros::serialization
