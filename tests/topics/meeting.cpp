#include "meeting.hpp"

#include <map>
#include <mutex>
#include <utility>

#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/ros2/session.hpp"
#include "spikeloop/topics/memory_session.hpp"
#include "tests/ros1/ros_peer.hpp"
#include "tests/ros1/settings.hpp"
#include "tests/ros2/domain.hpp"
#include "tests/support/roscore.hpp"

namespace spikeloop::test {
namespace {

class Ros1Meeting : public Meeting {
 public:
  topics::Session& session() override { return session_; }

  void publish_scan(const std::string& topic, const std::vector<float>& ranges, float range_min,
                    float range_max) override {
    robot_.publish_scan(topic, ranges, range_min, range_max);
  }
  void publish_twist(const std::string& topic, double linear_x, double angular_z) override {
    robot_.publish_twist(topic, linear_x, angular_z);
  }
  void publish_array(const std::string& topic, const std::vector<double>& data) override {
    robot_.publish_array(topic, data);
  }
  void publish_odometry(const std::string& topic, double x, double y, double z) override {
    robot_.publish_odometry(topic, x, y, z);
  }

  void listen_twist(const std::string& topic) override { robot_.listen_twist(topic); }
  void listen_array(const std::string& topic) override { robot_.listen_array(topic); }
  std::vector<std::array<double, 2>> twists() const override {
    std::vector<std::array<double, 2>> values;
    for (const ros_peer::Twist& twist : robot_.twists()) {
      values.push_back({twist.linear_x, twist.angular_z});
    }
    return values;
  }
  std::vector<std::vector<double>> arrays() const override { return robot_.arrays(); }

 private:
  RosCore core_;
  ros1::Session session_{node_at(core_.uri(), "adapter")};
  ros_peer::Peer robot_{core_.uri()};
};

/// A robot with a session of ours.
class OwnMeeting : public Meeting {
 public:
  OwnMeeting(topics::Session& session, topics::Session& robot) : session_(session), robot_(robot) {}
  topics::Session& session() override { return session_; }

  void publish_scan(const std::string& topic, const std::vector<float>& ranges, float range_min,
                    float range_max) override {
    publish(topic, "sensor_msgs/LaserScan",
            {{"ranges", {ranges.begin(), ranges.end()}},
             {"range_min", {static_cast<double>(range_min)}},
             {"range_max", {static_cast<double>(range_max)}}});
  }
  void publish_twist(const std::string& topic, double linear_x, double angular_z) override {
    publish(topic, "geometry_msgs/Twist", {{"linear.x", {linear_x}}, {"angular.z", {angular_z}}});
  }
  void publish_array(const std::string& topic, const std::vector<double>& data) override {
    publish(topic, "std_msgs/Float64MultiArray", {{"data", data}});
  }
  void publish_odometry(const std::string& topic, double x, double y, double z) override {
    publish(topic, "nav_msgs/Odometry",
            {{"pose.pose.position.x", {x}},
             {"pose.pose.position.y", {y}},
             {"pose.pose.position.z", {z}}});
  }

  void listen_twist(const std::string& topic) override {
    listen(topic, "geometry_msgs/Twist", {"linear.x", "angular.z"});
  }
  void listen_array(const std::string& topic) override {
    listen(topic, "std_msgs/Float64MultiArray", {"data"});
  }
  std::vector<std::array<double, 2>> twists() const override {
    std::vector<std::array<double, 2>> values;
    for (const auto& message : arrays()) {
      values.push_back({message.at(0), message.at(1)});
    }
    return values;
  }
  std::vector<std::vector<double>> arrays() const override {
    const std::lock_guard lock(mutex_);
    return heard_;
  }

 private:
  using Fields = std::vector<std::pair<std::string, std::vector<double>>>;

  const messages::Catalog& catalog() const {
    return messages::Catalog::builtin(session_.dialect());
  }

  void publish(const std::string& topic, const std::string& type, const Fields& fields) {
    std::vector<std::string> paths;
    std::vector<messages::FieldValue> values;
    for (const auto& [path, numbers] : fields) {
      paths.push_back(path);
      values.push_back({numbers, {}});
    }
    std::vector<std::byte> message;
    messages::MessageWriter(catalog(), type, paths).write(values, message);
    auto& publisher = publishers_[topic];
    if (!publisher) {
      publisher = robot_.publisher(topic, type);
    }
    publisher->publish(message);
  }

  void listen(const std::string& topic, const std::string& type,
              const std::vector<std::string>& paths) {
    std::vector<messages::FieldReader> readers;
    for (const std::string& path : paths) {
      readers.emplace_back(catalog(), type, path);
    }
    listeners_.push_back(robot_.subscriber(
        {.topic = topic, .message_type = type, .queue = 0, .take = [this, readers](auto message) {
           std::vector<double> values;
           for (const messages::FieldReader& reader : readers) {
             reader.read(message, values);
           }
           const std::lock_guard lock(mutex_);
           heard_.push_back(values);
         }}));
  }

  topics::Session& session_;
  topics::Session& robot_;
  mutable std::mutex mutex_;
  std::vector<std::vector<double>> heard_;
  std::map<std::string, std::unique_ptr<topics::RawPublisher>> publishers_;
  std::vector<std::unique_ptr<topics::RawSubscriber>> listeners_;
};

/// The sessions of an OwnMeeting, which ends before them.
struct MemorySessions {
  topics::MemorySession node;
};
class MemoryMeeting : MemorySessions, public OwnMeeting {
 public:
  MemoryMeeting() : OwnMeeting(node, node) {}
};

class Ros2Sessions {
 protected:
  topics::SessionSettings settings(const char* name) const {
    return {.node_name = name, .place = domain_.place()};
  }
  FreeDomain domain_;
  ros2::Session node_{settings("adapter")};
  ros2::Session robot_node_{settings("robot")};
};
class Ros2Meeting : Ros2Sessions, public OwnMeeting {
 public:
  Ros2Meeting() : OwnMeeting(node_, robot_node_) {}
};

}  // namespace

std::unique_ptr<Meeting> meet(Kind kind) {
  switch (kind) {
    case Kind::memory:
      return std::make_unique<MemoryMeeting>();
    case Kind::ros1:
      return std::make_unique<Ros1Meeting>();
    case Kind::ros2:
      break;
  }
  return std::make_unique<Ros2Meeting>();
}

}  // namespace spikeloop::test
