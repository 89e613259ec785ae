// Everything that the robot tells: topics, and when their messages are due.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/messages/dialect.hpp"
#include "spikeloop/pictures/camera.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::robot {

struct SensorOptions {
  messages::Dialect dialect = messages::Dialect::ros1;
  /// None: the camera is off.
  std::optional<pictures::CameraOptions> camera{};
  /// Pictures are black: only their size is asked for, and OpenGL is not needed.
  bool blind = false;
  /// Messages in a simulated second of a robot that is not the vehicle, pictures aside.
  double rate_hz = 100;
};

struct SensorTopic {
  std::string name;  ///< "scan"; with a '/' before it where no prefix belongs
  std::string type;
  TimeNs period = 0;  ///< 0: one message, at the start

  /// Who subscribes later gets it, too.
  bool latched() const { return period == 0; }
};

/// | topic             | carries                    | every                     |
/// |-------------------|----------------------------|---------------------------|
/// | scan              | sensor_msgs/LaserScan      | as the world says (50 ms) |
/// | odom              | nav_msgs/Odometry          | 20 ms                     |
/// | imu               | sensor_msgs/Imu            | 10 ms                     |
/// | joint_states      | sensor_msgs/JointState     | 20 ms                     |
/// | /tf               | tf2_msgs/TFMessage         | 20 ms                     |
/// | /tf_static        | tf2_msgs/TFMessage         | once, latched             |
/// | light             | std_msgs/Float64MultiArray | 20 ms, in a world with lamps |
/// | lane              | std_msgs/Float64MultiArray | 20 ms, in a world with lanes |
/// | camera/image_raw  | sensor_msgs/Image          | as its options say        |
/// | camera/camera_info | sensor_msgs/CameraInfo    | with the image            |
///
/// A robot that is not the vehicle has, beside its camera,
///
/// | topic             | carries                                     | every        |
/// |-------------------|---------------------------------------------|--------------|
/// | joint_states      | sensor_msgs/JointState                      | 1 / rate_hz  |
/// | imu, or imu/SITE  | sensor_msgs/Imu of a site with <accelerometer> and <gyro>  | 1 / rate_hz |
/// | sensors/NAME      | std_msgs/Float64MultiArray of that <sensor> | 1 / rate_hz  |
class Sensors {
 public:
  /// @throws ConfigurationError, TransportError as pictures::Camera.
  Sensors(const vehicle::Simulation& robot, const SensorOptions& options);
  ~Sensors();
  Sensors(Sensors&&) noexcept;
  Sensors& operator=(Sensors&&) noexcept;

  /// The stamp of simulated time 0, from now on; 0 unless it is set.
  void begin_stamps(TimeNs stamp);
  const std::vector<SensorTopic>& topics() const;
  /// Adds a std_msgs/Float64MultiArray of what `numbers` returns.
  void add_numbers(const std::string& name, TimeNs period,
                   std::function<std::vector<double>()> numbers);
  /// The message of a topic as things are now. Holds until its next one.
  /// @param index in topics()
  std::span<const std::byte> write(std::size_t index, const vehicle::Simulation& robot);

  /// Whether a message has become due since the last call, each multiple of the period at most
  /// once; time 0 is one. Of a topic without a period at the first call.
  bool due(std::size_t index, TimeNs time);
  /// All messages but those without a period are due now: the robot has begun anew.
  void begin_anew();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::robot
