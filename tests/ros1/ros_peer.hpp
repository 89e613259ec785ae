// The robot's side: publishes and receives with roscpp's generated messages. Compiled as C++17.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace ros_peer {

struct Twist {
  double linear_x = 0;
  double angular_z = 0;
  std::int64_t time_ns = 0;  ///< monotonic clock, on arrival
  std::string publisher{};   ///< the node that sent it

  bool is_zero() const { return linear_x == 0 && angular_z == 0; }
};

/// Of an event camera.
struct CameraEvent {
  int x = 0;
  int y = 0;
  bool on = false;
  std::int64_t stamp_ns = 0;
};

/// One a process. Its callbacks run in a thread of its own.
class Peer {
 public:
  explicit Peer(const std::string& master_uri);
  ~Peer();

  void publish_scan(const std::string& topic, const std::vector<float>& ranges, float range_min,
                    float range_max);
  void publish_twist(const std::string& topic, double linear_x, double angular_z);
  void publish_array(const std::string& topic, const std::vector<double>& data);
  void publish_odometry(const std::string& topic, double x, double y, double z);
  /// dvs_msgs/EventArray of a camera of this size.
  void publish_events(const std::string& topic, int width, int height,
                      const std::vector<CameraEvent>& events);
  /// Once a message has been published there (or advertised by these): how many listen.
  int subscribers(const std::string& topic) const;

  void listen_twist(const std::string& topic);
  void listen_array(const std::string& topic);
  std::vector<Twist> twists() const;
  std::vector<std::vector<double>> arrays() const;
  int publishers(const std::string& topic) const;
  /// Full names of the nodes that the master knows.
  std::vector<std::string> nodes() const;
  /// Where this node, which is no master, answers calls.
  std::string node_uri() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Looks every 2 ms; false after `seconds`.
bool eventually(double seconds, const std::function<bool()>& condition);
std::int64_t monotonic_now();

}  // namespace ros_peer
