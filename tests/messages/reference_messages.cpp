#include "reference_messages.hpp"

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/PoseWithCovariance.h>
#include <geometry_msgs/Quaternion.h>
#include <geometry_msgs/Twist.h>
#include <geometry_msgs/TwistWithCovariance.h>
#include <geometry_msgs/Vector3.h>
#include <nav_msgs/Odometry.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/LaserScan.h>
#include <std_msgs/Empty.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>
#include <std_msgs/Header.h>
#include <std_msgs/MultiArrayDimension.h>
#include <std_msgs/MultiArrayLayout.h>
#include <std_msgs/String.h>

#include <functional>
#include <random>
#include <stdexcept>

namespace reference {
namespace {

class Filler {
 public:
  explicit Filler(unsigned seed) : engine_(seed) {}

  std::size_t size() { return std::uniform_int_distribution<std::size_t>(0, 12)(engine_); }

  void number(const std::string& path, double& field) {
    field = std::normal_distribution<double>(0, 100)(engine_);
    message.numbers[path].push_back(field);
  }
  void number(const std::string& path, float& field) {
    field = std::normal_distribution<float>(0, 100)(engine_);
    message.numbers[path].push_back(field);
  }
  void number(const std::string& path, std::uint32_t& field) {
    field = std::uniform_int_distribution<std::uint32_t>()(engine_);
    message.numbers[path].push_back(field);
  }
  template <typename Numbers>
  void numbers(const std::string& path, Numbers& fields) {
    message.numbers[path];
    for (auto& field : fields) {
      number(path, field);
    }
  }
  void text(const std::string& path, std::string& field) {
    for (std::size_t i = size(); i > 0; --i) {
      field.push_back(std::uniform_int_distribution<char>('a', 'z')(engine_));
    }
    message.texts[path] = field;
  }
  void time(const std::string& path, ros::Time& field) {
    number(path + ".secs", field.sec);
    field.nsec = std::uniform_int_distribution<std::uint32_t>(0, 999999999)(engine_);
    message.numbers[path + ".nsecs"].push_back(field.nsec);
  }

  Message message;

 private:
  std::mt19937 engine_;
};

void fill(Filler& f, const std::string& p, std_msgs::Header& m) {
  f.number(p + "seq", m.seq);
  f.time(p + "stamp", m.stamp);
  f.text(p + "frame_id", m.frame_id);
}
void fill(Filler& f, const std::string& p, std_msgs::MultiArrayDimension& m) {
  f.text(p + "label", m.label);
  f.number(p + "size", m.size);
  f.number(p + "stride", m.stride);
}
void fill(Filler& f, const std::string& p, std_msgs::MultiArrayLayout& m) {
  m.dim.resize(f.size());
  for (std::size_t i = 0; i < m.dim.size(); ++i) {
    fill(f, p + "dim[" + std::to_string(i) + "].", m.dim[i]);
  }
  f.number(p + "data_offset", m.data_offset);
}
void fill(Filler& f, const std::string& p, std_msgs::Float64MultiArray& m) {
  fill(f, p + "layout.", m.layout);
  m.data.resize(f.size());
  f.numbers(p + "data", m.data);
}
void fill(Filler& f, const std::string& p, std_msgs::String& m) {
  f.text(p + "data", m.data);
}
void fill(Filler& f, const std::string& p, std_msgs::Float64& m) {
  f.number(p + "data", m.data);
}
void fill(Filler&, const std::string&, std_msgs::Empty&) {}

template <typename Vector>
void fill_xyz(Filler& f, const std::string& p, Vector& m) {
  f.number(p + "x", m.x);
  f.number(p + "y", m.y);
  f.number(p + "z", m.z);
}
void fill(Filler& f, const std::string& p, geometry_msgs::Vector3& m) {
  fill_xyz(f, p, m);
}
void fill(Filler& f, const std::string& p, geometry_msgs::Point& m) {
  fill_xyz(f, p, m);
}
void fill(Filler& f, const std::string& p, geometry_msgs::Quaternion& m) {
  fill_xyz(f, p, m);
  f.number(p + "w", m.w);
}
void fill(Filler& f, const std::string& p, geometry_msgs::Pose& m) {
  fill(f, p + "position.", m.position);
  fill(f, p + "orientation.", m.orientation);
}
void fill(Filler& f, const std::string& p, geometry_msgs::PoseWithCovariance& m) {
  fill(f, p + "pose.", m.pose);
  f.numbers(p + "covariance", m.covariance);
}
void fill(Filler& f, const std::string& p, geometry_msgs::Twist& m) {
  fill(f, p + "linear.", m.linear);
  fill(f, p + "angular.", m.angular);
}
void fill(Filler& f, const std::string& p, geometry_msgs::TwistWithCovariance& m) {
  fill(f, p + "twist.", m.twist);
  f.numbers(p + "covariance", m.covariance);
}
void fill(Filler& f, const std::string& p, sensor_msgs::LaserScan& m) {
  fill(f, p + "header.", m.header);
  f.number(p + "angle_min", m.angle_min);
  f.number(p + "angle_max", m.angle_max);
  f.number(p + "angle_increment", m.angle_increment);
  f.number(p + "time_increment", m.time_increment);
  f.number(p + "scan_time", m.scan_time);
  f.number(p + "range_min", m.range_min);
  f.number(p + "range_max", m.range_max);
  m.ranges.resize(f.size());
  f.numbers(p + "ranges", m.ranges);
  m.intensities.resize(f.size());
  f.numbers(p + "intensities", m.intensities);
}
void fill(Filler& f, const std::string& p, nav_msgs::Odometry& m) {
  fill(f, p + "header.", m.header);
  f.text(p + "child_frame_id", m.child_frame_id);
  fill(f, p + "pose.", m.pose);
  fill(f, p + "twist.", m.twist);
}
void fill(Filler& f, const std::string& p, rosgraph_msgs::Clock& m) {
  f.time(p + "clock", m.clock);
}

template <typename Type>
Message make(unsigned seed) {
  Filler filler(seed);
  Type content;
  fill(filler, "", content);
  Message message = filler.message;
  message.md5 = ros::message_traits::MD5Sum<Type>::value();
  message.definition = ros::message_traits::Definition<Type>::value();
  message.bytes.resize(ros::serialization::serializationLength(content));
  ros::serialization::OStream stream(message.bytes.data(),
                                     static_cast<std::uint32_t>(message.bytes.size()));
  ros::serialization::serialize(stream, content);
  return message;
}

const std::map<std::string, std::function<Message(unsigned)>>& makers() {
  static const std::map<std::string, std::function<Message(unsigned)>> all = {
      {"std_msgs/Header", make<std_msgs::Header>},
      {"std_msgs/MultiArrayDimension", make<std_msgs::MultiArrayDimension>},
      {"std_msgs/MultiArrayLayout", make<std_msgs::MultiArrayLayout>},
      {"std_msgs/Float64MultiArray", make<std_msgs::Float64MultiArray>},
      {"std_msgs/String", make<std_msgs::String>},
      {"std_msgs/Float64", make<std_msgs::Float64>},
      {"std_msgs/Empty", make<std_msgs::Empty>},
      {"geometry_msgs/Vector3", make<geometry_msgs::Vector3>},
      {"geometry_msgs/Point", make<geometry_msgs::Point>},
      {"geometry_msgs/Quaternion", make<geometry_msgs::Quaternion>},
      {"geometry_msgs/Pose", make<geometry_msgs::Pose>},
      {"geometry_msgs/PoseWithCovariance", make<geometry_msgs::PoseWithCovariance>},
      {"geometry_msgs/Twist", make<geometry_msgs::Twist>},
      {"geometry_msgs/TwistWithCovariance", make<geometry_msgs::TwistWithCovariance>},
      {"sensor_msgs/LaserScan", make<sensor_msgs::LaserScan>},
      {"nav_msgs/Odometry", make<nav_msgs::Odometry>},
      {"rosgraph_msgs/Clock", make<rosgraph_msgs::Clock>},
  };
  return all;
}

}  // namespace

std::vector<std::string> types() {
  std::vector<std::string> names;
  for (const auto& [name, maker] : makers()) {
    names.push_back(name);
  }
  return names;
}

Message random_message(const std::string& type, unsigned seed) {
  return makers().at(type)(seed);
}

}  // namespace reference
