#include "ros_peer.hpp"

#include <geometry_msgs/Twist.h>
#include <nav_msgs/Odometry.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <ros/xmlrpc_manager.h>
#include <sensor_msgs/LaserScan.h>
#include <std_msgs/Float64MultiArray.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <map>
#include <mutex>
#include <thread>

#include "dvs_messages.hpp"
#include "spikeloop/core/priority.hpp"

namespace ros_peer {

std::int64_t monotonic_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

bool eventually(double seconds, const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

struct Peer::Impl {
  ros::CallbackQueue queue;
  std::unique_ptr<ros::NodeHandle> node;
  std::map<std::string, ros::Publisher> publishers;
  std::map<std::string, ros::Subscriber> subscribers;
  std::atomic<bool> ending{false};
  std::thread thread;
  mutable std::mutex mutex;
  std::vector<Twist> twists;
  std::vector<std::vector<double>> arrays;

  void start(const std::string& master_uri) {
    if (!ros::isInitialized()) {
      // A machine need not know its own name.
      ::setenv("ROS_HOSTNAME", "localhost", 0);
      ros::init(ros::M_string{{"__master", master_uri}}, "test_robot",
                ros::init_options::NoSigintHandler | ros::init_options::NoRosout |
                    ros::init_options::AnonymousName);
    }
    node.reset(new ros::NodeHandle);
    node->setCallbackQueue(&queue);
    thread = std::thread([this] {
      while (!ending) {
        queue.callAvailable(ros::WallDuration(0.05));
      }
    });
  }

  template <typename Message>
  void publish(const std::string& topic, const Message& message, std::uint32_t queue = 10) {
    auto& publisher = publishers[topic];
    if (!publisher) {
      publisher = node->advertise<Message>(topic, queue);
    }
    publisher.publish(message);
  }
};

Peer::Peer(const std::string& master_uri) : impl_(new Impl) {
  // A robot that hears late on a busy machine would have the stop look late.
  std::thread([&] {
    spikeloop::run_before_others();
    impl_->start(master_uri);
  }).join();
}

Peer::~Peer() {
  impl_->ending = true;
  impl_->thread.join();
  impl_->subscribers.clear();
  impl_->publishers.clear();
}

void Peer::publish_scan(const std::string& topic, const std::vector<float>& ranges, float range_min,
                        float range_max) {
  sensor_msgs::LaserScan scan;
  scan.header.frame_id = "laser";
  scan.range_min = range_min;
  scan.range_max = range_max;
  scan.ranges = ranges;
  scan.intensities.assign(ranges.size(), 1.0f);
  impl_->publish(topic, scan);
}

void Peer::publish_twist(const std::string& topic, double linear_x, double angular_z) {
  geometry_msgs::Twist twist;
  twist.linear.x = linear_x;
  twist.angular.z = angular_z;
  impl_->publish(topic, twist);
}

void Peer::publish_array(const std::string& topic, const std::vector<double>& data) {
  std_msgs::Float64MultiArray array;
  array.data = data;
  impl_->publish(topic, array);
}

void Peer::publish_odometry(const std::string& topic, double x, double y, double z) {
  nav_msgs::Odometry odometry;
  odometry.pose.pose.position.x = x;
  odometry.pose.pose.position.y = y;
  odometry.pose.pose.position.z = z;
  impl_->publish(topic, odometry);
}

void Peer::publish_events(const std::string& topic, int width, int height,
                          const std::vector<CameraEvent>& events) {
  dvs_msgs::EventArray array;
  array.header.frame_id = "dvs";
  array.width = static_cast<std::uint32_t>(width);
  array.height = static_cast<std::uint32_t>(height);
  for (const CameraEvent& event : events) {
    dvs_msgs::Event made;
    made.x = static_cast<std::uint16_t>(event.x);
    made.y = static_cast<std::uint16_t>(event.y);
    made.ts.fromNSec(static_cast<std::uint64_t>(event.stamp_ns));
    made.polarity = event.on ? 1 : 0;
    array.events.push_back(made);
  }
  impl_->publish(topic, array, 1000);
}

int Peer::subscribers(const std::string& topic) const {
  const auto found = impl_->publishers.find(topic);
  return found == impl_->publishers.end() ? 0 : static_cast<int>(found->second.getNumSubscribers());
}

void Peer::listen_twist(const std::string& topic) {
  impl_->subscribers[topic] = impl_->node->subscribe<geometry_msgs::Twist>(
      topic, 1000,
      boost::function<void(const ros::MessageEvent<geometry_msgs::Twist const>&)>(
          [this](const ros::MessageEvent<geometry_msgs::Twist const>& event) {
            const auto twist = event.getConstMessage();
            const std::lock_guard<std::mutex> lock(impl_->mutex);
            impl_->twists.push_back(
                {twist->linear.x, twist->angular.z, monotonic_now(), event.getPublisherName()});
          }));
}

void Peer::listen_array(const std::string& topic) {
  impl_->subscribers[topic] = impl_->node->subscribe<std_msgs::Float64MultiArray>(
      topic, 1000, [this](const std_msgs::Float64MultiArray::ConstPtr& array) {
        const std::lock_guard<std::mutex> lock(impl_->mutex);
        impl_->arrays.push_back(array->data);
      });
}

std::vector<Twist> Peer::twists() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->twists;
}

std::vector<std::vector<double>> Peer::arrays() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->arrays;
}

int Peer::publishers(const std::string& topic) const {
  const auto found = impl_->subscribers.find(topic);
  return found == impl_->subscribers.end() ? 0 : static_cast<int>(found->second.getNumPublishers());
}

std::vector<std::string> Peer::nodes() const {
  std::vector<std::string> names;
  ros::master::getNodes(names);
  return names;
}

std::string Peer::node_uri() const {
  return ros::XMLRPCManager::instance()->getServerURI();
}

}  // namespace ros_peer
