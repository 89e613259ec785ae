// Messages of ROS 2 as Fast DDS and Fast-CDR carry them, written by hand: they share nothing with
// ours.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastdds/dds/topic/TopicDataType.hpp>

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace fastdds_peer {

using eprosima::fastcdr::Cdr;

struct LaserScan {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  std::string frame_id;
  float angle_min = 0, angle_max = 0, angle_increment = 0, time_increment = 0, scan_time = 0;
  float range_min = 0, range_max = 0;
  std::vector<float> ranges, intensities;

  static const char* type() { return "sensor_msgs::msg::dds_::LaserScan_"; }
  std::size_t most_bytes() const { return 100 + frame_id.size() + 4 * ranges.size(); }
  void write(Cdr& cdr) const {
    cdr << sec << nanosec << frame_id << angle_min << angle_max << angle_increment << time_increment
        << scan_time << range_min << range_max << ranges << intensities;
  }
  void read(Cdr& cdr) {
    cdr >> sec >> nanosec >> frame_id >> angle_min >> angle_max >> angle_increment >>
        time_increment >> scan_time >> range_min >> range_max >> ranges >> intensities;
  }
};

struct Twist {
  std::array<double, 6> values{};  // linear x, y, z, angular x, y, z

  static const char* type() { return "geometry_msgs::msg::dds_::Twist_"; }
  std::size_t most_bytes() const { return 60; }
  void write(Cdr& cdr) const { cdr.serializeArray(values.data(), values.size()); }
  void read(Cdr& cdr) { cdr.deserializeArray(values.data(), values.size()); }
};

struct Image {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  std::string frame_id;
  std::uint32_t height = 0, width = 0;
  std::string encoding;
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;
  std::vector<std::uint8_t> data;

  static const char* type() { return "sensor_msgs::msg::dds_::Image_"; }
  std::size_t most_bytes() const { return 100 + frame_id.size() + encoding.size() + data.size(); }
  void write(Cdr& cdr) const {
    cdr << sec << nanosec << frame_id << height << width << encoding << is_bigendian << step
        << data;
  }
  void read(Cdr& cdr) {
    cdr >> sec >> nanosec >> frame_id >> height >> width >> encoding >> is_bigendian >> step >>
        data;
  }
};

struct Log {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  std::uint8_t level = 0;
  std::string name, text, file, function;
  std::uint32_t line = 0;

  static const char* type() { return "rcl_interfaces::msg::dds_::Log_"; }
  std::size_t most_bytes() const { return 1000; }
  void write(Cdr& cdr) const {
    cdr << sec << nanosec << level << name << text << file << function << line;
  }
  void read(Cdr& cdr) {
    cdr >> sec >> nanosec >> level >> name >> text >> file >> function >> line;
  }
};

/// All numbers are 0 when it is sent, and none is looked at when it comes.
struct Odometry {
  std::string frame_id = "odom", child_frame_id = "base_link";
  std::array<double, 7 + 36 + 6 + 36> values{};  // pose, twist, each with its covariance

  static const char* type() { return "nav_msgs::msg::dds_::Odometry_"; }
  std::size_t most_bytes() const { return 100 + sizeof values; }
  void write(Cdr& cdr) const {
    cdr << std::int32_t{0} << std::uint32_t{0} << frame_id << child_frame_id;
    cdr.serializeArray(values.data(), values.size());
  }
  void read(Cdr& cdr) {
    std::int32_t sec = 0;
    std::uint32_t nanosec = 0;
    cdr >> sec >> nanosec >> frame_id >> child_frame_id;
    cdr.deserializeArray(values.data(), values.size());
  }
};

struct Bool {
  std::uint8_t data = 0;

  static const char* type() { return "std_msgs::msg::dds_::Bool_"; }
  std::size_t most_bytes() const { return 8; }
  void write(Cdr& cdr) const { cdr << data; }
  void read(Cdr& cdr) { cdr >> data; }
};

struct String {
  std::string data;

  static const char* type() { return "std_msgs::msg::dds_::String_"; }
  std::size_t most_bytes() const { return 16 + data.size(); }
  void write(Cdr& cdr) const { cdr << data; }
  void read(Cdr& cdr) { cdr >> data; }
};

/// gazebo_msgs/ContactsState: the names of the two bodies of each contact, all else empty or 0.
struct ContactsState {
  std::vector<std::pair<std::string, std::string>> contacts;

  static const char* type() { return "gazebo_msgs::msg::dds_::ContactsState_"; }
  std::size_t most_bytes() const { return 4096; }
  void write(Cdr& cdr) const {
    const std::string empty;
    const std::uint32_t none = 0;
    const std::array<double, 6> total_wrench{};
    cdr << std::int32_t{0} << none << empty << static_cast<std::uint32_t>(contacts.size());
    for (const auto& [first, second] : contacts) {
      cdr << empty << first << second << none;
      cdr.serializeArray(total_wrench.data(), total_wrench.size());
      cdr << none << none << none;
    }
  }
  void read(Cdr&) { throw std::logic_error("nobody receives contacts here"); }
};

/// Without dimensions.
struct Float64MultiArray {
  std::vector<double> data;

  static const char* type() { return "std_msgs::msg::dds_::Float64MultiArray_"; }
  std::size_t most_bytes() const { return 32 + 8 * data.size(); }
  void write(Cdr& cdr) const { cdr << std::uint32_t{0} << std::uint32_t{0} << data; }
  void read(Cdr& cdr) {
    std::uint32_t dimensions = 0, offset = 0;
    cdr >> dimensions >> offset >> data;
  }
};

/// The newest status alone is kept.
struct DiagnosticArray {
  std::uint8_t level = 0;
  std::string name, message;
  std::vector<std::pair<std::string, std::string>> values;

  static const char* type() { return "diagnostic_msgs::msg::dds_::DiagnosticArray_"; }
  std::size_t most_bytes() const { return 4096; }
  void write(Cdr&) const { throw std::logic_error("nobody sends diagnostics here"); }
  void read(Cdr& cdr) {
    std::int32_t sec = 0;
    std::uint32_t nanosec = 0, statuses = 0, pairs = 0;
    std::string frame_id, hardware_id;
    cdr >> sec >> nanosec >> frame_id >> statuses;
    for (; statuses > 0; --statuses) {
      cdr >> level >> name >> message >> hardware_id >> pairs;
      values.resize(pairs);
      for (auto& [key, value] : values) {
        cdr >> key >> value;
      }
    }
  }
};

/// rmw_dds_common/ParticipantEntitiesInfo, with identities of 24 bytes until Humble, 16 since Iron.
template <std::size_t GidBytes>
struct ParticipantEntitiesInfo {
  using Gid = std::array<std::uint8_t, GidBytes>;
  struct Node {
    std::string space, name;
    std::vector<Gid> readers, writers;
  };
  Gid gid{};
  std::vector<Node> nodes;

  static const char* type() { return "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"; }
  std::size_t most_bytes() const { return 100; }
  void write(Cdr& cdr) const {  // nobody needs a node of the peer's
    cdr.serializeArray(gid.data(), gid.size());
    cdr << std::uint32_t{0};
  }
  void read(Cdr& cdr) {
    cdr.deserializeArray(gid.data(), gid.size());
    nodes.resize(length(cdr));
    for (Node& node : nodes) {
      cdr >> node.space >> node.name;
      read(cdr, node.readers);
      read(cdr, node.writers);
    }
  }

 private:
  static std::uint32_t length(Cdr& cdr) {
    std::uint32_t count = 0;
    cdr >> count;
    return count;
  }
  static void read(Cdr& cdr, std::vector<Gid>& gids) {
    gids.resize(length(cdr));
    for (Gid& one : gids) {
      cdr.deserializeArray(one.data(), one.size());
    }
  }
};

template <typename Message>
class Type : public eprosima::fastdds::dds::TopicDataType {
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
  using Handle = eprosima::fastrtps::rtps::InstanceHandle_t;

 public:
  Type() {
    setName(Message::type());
    m_typeSize = 4096;
    m_isGetKeyDefined = false;
    auto_fill_type_information(false);  // as rmw_fastrtps until Jazzy
    auto_fill_type_object(false);
  }

  bool serialize(void* data, Payload* payload) override {
    eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->max_size);
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    cdr.serialize_encapsulation();
    static_cast<const Message*>(data)->write(cdr);
    payload->encapsulation = CDR_LE;
    payload->length = static_cast<std::uint32_t>(cdr.getSerializedDataLength());
    return true;
  }
  /// What a message of another layout makes Fast-CDR throw goes on to whoever takes it.
  bool deserialize(Payload* payload, void* data) override {
    eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->length);
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    cdr.read_encapsulation();
    static_cast<Message*>(data)->read(cdr);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] {
      return static_cast<std::uint32_t>(static_cast<const Message*>(data)->most_bytes());
    };
  }
  void* createData() override { return new Message; }
  void deleteData(void* data) override { delete static_cast<Message*>(data); }
  bool getKey(void*, Handle*, bool) override { return false; }
};

}  // namespace fastdds_peer
