#include "spikeloop/robot/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "spikeloop/robot/messages.hpp"

namespace spikeloop::robot {
namespace {

using vehicle::Vehicle;

constexpr TimeNs kMillisecond = 1'000'000;

/// To the microsecond, and no more often than every millisecond: a float's period, as 0.05 s,
/// would be due a nanosecond after its tick.
TimeNs rounded(double seconds) {
  return std::max<TimeNs>(kMillisecond, 1000 * std::llround(seconds * 1e6));
}

}  // namespace

class Sensors::Impl {
 public:
  Impl(const Vehicle& vehicle, const SensorOptions& options) : dialect_(options.dialect) {
    add("scan", kScanType, rounded(static_cast<double>(vehicle.scan().scan_time_s)),
        writer<ScanMessage>(&Vehicle::scan));
    add("odom", kOdometryType, 20 * kMillisecond, writer<OdometryMessage>(&Vehicle::odometry));
    add("imu", kImuType, 10 * kMillisecond, writer<ImuMessage>(&Vehicle::imu));
    add("joint_states", kJointStateType, 20 * kMillisecond,
        writer<JointStateMessage>(&Vehicle::joint_states));
    add_transforms(vehicle);
    if (vehicle.light()) add_light();
    if (options.camera) add_camera(vehicle, *options.camera, options.blind);
  }

  const std::vector<SensorTopic>& topics() const { return topics_; }
  std::span<const std::byte> write(std::size_t index, const Vehicle& vehicle) {
    return writers_[index](vehicle);
  }

  bool due(std::size_t index, TimeNs time) {
    if (time < next_[index]) return false;
    const TimeNs period = topics_[index].period;
    next_[index] = period == 0 ? kNever : (time / period + 1) * period;
    return true;
  }

 private:
  using Bytes = std::span<const std::byte>;
  using Write = std::function<Bytes(const Vehicle&)>;

  void add(const char* name, const char* type, TimeNs period, Write write) {
    topics_.push_back({name, type, period});
    writers_.push_back(std::move(write));
    next_.push_back(0);
  }

  template <typename Message, typename Value>
  Write writer(Value (Vehicle::*value)() const) const {
    const auto message = std::make_shared<Message>(dialect_);
    return [message, value](const Vehicle& vehicle) -> Bytes {
      return message->write((vehicle.*value)());
    };
  }

  void add_transforms(const Vehicle& vehicle) {
    add("/tf", kTransformType, 20 * kMillisecond, writer<TransformMessage>(&Vehicle::odometry));
    const auto fixed = std::make_shared<StaticTransformMessage>(dialect_, vehicle.laser_mount(),
                                                                vehicle.camera_mount());
    add("/tf_static", kTransformType, 0,
        [fixed](const Vehicle& now) -> Bytes { return fixed->write(now.time()); });
  }

  void add_light() {
    const auto message = std::make_shared<LightMessage>(dialect_);
    add("light", kLightType, 20 * kMillisecond,
        [message](const Vehicle& now) -> Bytes { return message->write(*now.light()); });
  }

  void add_camera(const Vehicle& vehicle, const pictures::CameraOptions& options, bool blind) {
    const TimeNs period = rounded(1 / options.rate_hz);
    const auto image = std::make_shared<ImageMessage>(dialect_);
    if (blind) {
      const auto size = static_cast<std::size_t>(options.size.width) * options.size.height;
      add("camera/image_raw", kImageType, period,
          [image, black = pictures::Image{options.size, std::vector<std::uint8_t>(3 * size)}](
              const Vehicle& now) -> Bytes { return image->write(now.time(), black); });
    } else {
      const auto camera = std::make_shared<pictures::Camera>(vehicle, options);
      add("camera/image_raw", kImageType, period, [image, camera](const Vehicle& now) -> Bytes {
        return image->write(now.time(), camera->look(now));
      });
    }
    const auto info = std::make_shared<CameraInfoMessage>(dialect_);
    add("camera/camera_info", kCameraInfoType, period,
        [info, options](const Vehicle& now) -> Bytes { return info->write(now.time(), options); });
  }

  messages::Dialect dialect_;
  std::vector<SensorTopic> topics_;
  std::vector<Write> writers_;  // of each topic
  std::vector<TimeNs> next_;
};

Sensors::Sensors(const Vehicle& vehicle, const SensorOptions& options)
    : impl_(std::make_unique<Impl>(vehicle, options)) {}
Sensors::~Sensors() = default;
Sensors::Sensors(Sensors&&) noexcept = default;
Sensors& Sensors::operator=(Sensors&&) noexcept = default;

const std::vector<SensorTopic>& Sensors::topics() const {
  return impl_->topics();
}
std::span<const std::byte> Sensors::write(std::size_t index, const Vehicle& vehicle) {
  return impl_->write(index, vehicle);
}
bool Sensors::due(std::size_t index, TimeNs time) {
  return impl_->due(index, time);
}

}  // namespace spikeloop::robot
