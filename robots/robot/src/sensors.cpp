#include "spikeloop/robot/sensors.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <limits>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/robot/messages.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::robot {
namespace {

using vehicle::Simulation;
using vehicle::Vehicle;

constexpr TimeNs kMillisecond = 1'000'000;

/// To the microsecond, and no more often than every millisecond: a float's period, as 0.05 s,
/// would be due a nanosecond after its tick.
TimeNs rounded(double seconds) {
  return std::max<TimeNs>(kMillisecond, 1000 * std::llround(seconds * 1e6));
}

/// A name of MJCF as part of a topic's, which has letters, digits and '_'.
std::string topic_part(std::string name) {
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return std::isdigit(static_cast<unsigned char>(name.front())) != 0 ? "_" + name : name;
}

}  // namespace

class Sensors::Impl {
 public:
  Impl(const Simulation& robot, const SensorOptions& options) : dialect_(options.dialect) {
    if (const Vehicle* const vehicle = robot.vehicle()) {
      add_vehicle(*vehicle);
    } else {
      add_model(robot, rounded(1 / options.rate_hz));
    }
    if (options.camera) add_camera(robot, *options.camera, options.blind);
  }

  void begin_stamps(TimeNs stamp) { begin_ = stamp; }
  const std::vector<SensorTopic>& topics() const { return topics_; }
  std::span<const std::byte> write(std::size_t index, const Simulation& robot) {
    return writers_[index](robot);
  }

  void add_numbers(const std::string& name, TimeNs period,
                   std::function<std::vector<double>()> numbers) {
    add(name, kNumbersType, period,
        [message = std::make_shared<NumbersMessage>(dialect_), numbers = std::move(numbers)](
            const Simulation&) -> Bytes { return message->write(numbers()); });
  }

  bool due(std::size_t index, TimeNs time) {
    if (time < next_[index]) return false;
    const TimeNs period = topics_[index].period;
    next_[index] = period == 0 ? kNever : (time / period + 1) * period;
    return true;
  }

  void begin_anew() {
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      if (topics_[i].period != 0) next_[i] = 0;
    }
  }

 private:
  using Bytes = std::span<const std::byte>;
  using Write = std::function<Bytes(const Simulation&)>;

  void add(const std::string& name, const char* type, TimeNs period, Write write) {
    if (std::ranges::find(topics_, name, &SensorTopic::name) != topics_.end()) {
      throw ConfigurationError(with_code(
          Code::world,
          "two sensors of the model have the topic {}; give them names that differ in letters and "
          "digits",
          name));
    }
    topics_.push_back({name, type, period});
    writers_.push_back(std::move(write));
    next_.push_back(0);
  }

  template <typename Measurement>
  Measurement stamped(Measurement measurement) const {
    measurement.stamp += begin_;
    return measurement;
  }

  template <typename Message, typename Value>
  Write writer(Value (Vehicle::*value)() const) const {
    const auto message = std::make_shared<Message>(dialect_);
    return [this, message, value](const Simulation& robot) -> Bytes {
      return message->write(stamped((robot.vehicle()->*value)()));
    };
  }

  void add_vehicle(const Vehicle& vehicle) {
    add("scan", kScanType, rounded(static_cast<double>(vehicle.scan().scan_time_s)),
        writer<ScanMessage>(&Vehicle::scan));
    add("odom", kOdometryType, 20 * kMillisecond, writer<OdometryMessage>(&Vehicle::odometry));
    add("imu", kImuType, 10 * kMillisecond, writer<ImuMessage>(&Vehicle::imu));
    add_joints(vehicle, 20 * kMillisecond);
    add_transforms(vehicle);
    if (vehicle.light()) add_light();
    if (!vehicle.lanes().empty()) add_lane();
  }

  void add_model(const Simulation& robot, TimeNs period) {
    add_joints(robot, period);
    add_inertial_units(robot, period);
    for (std::size_t i = 0; i < robot.sensors().size(); ++i) {
      const std::string name = "sensors/" + topic_part(robot.sensors()[i].name);
      const auto message = std::make_shared<NumbersMessage>(dialect_);
      add(name, kNumbersType, period, [message, i](const Simulation& now) -> Bytes {
        return message->write(now.read_sensor(i));
      });
    }
  }

  void add_inertial_units(const Simulation& robot, TimeNs period) {
    const auto& units = robot.inertial_units();
    for (std::size_t i = 0; i < units.size(); ++i) {
      const auto message = std::make_shared<ImuMessage>(dialect_, units[i].site);
      add(units.size() == 1 ? "imu" : "imu/" + topic_part(units[i].site), kImuType, period,
          [this, message, i](const Simulation& now) -> Bytes {
            return message->write(stamped(now.read_inertial_unit(i)));
          });
    }
  }

  void add_joints(const Simulation& robot, TimeNs period) {
    const auto message =
        std::make_shared<JointStateMessage>(dialect_, robot.joint_states().names.size());
    add("joint_states", kJointStateType, period, [this, message](const Simulation& now) -> Bytes {
      return message->write(stamped(now.joint_states()));
    });
  }

  void add_transforms(const Vehicle& vehicle) {
    add("/tf", kTransformType, 20 * kMillisecond, writer<TransformMessage>(&Vehicle::odometry));
    const auto fixed = std::make_shared<StaticTransformMessage>(dialect_, vehicle.laser_mount(),
                                                                vehicle.camera_mount());
    add("/tf_static", kTransformType, 0, [this, fixed](const Simulation& now) -> Bytes {
      return fixed->write(begin_ + now.time());
    });
  }

  void add_light() {
    const auto message = std::make_shared<NumbersMessage>(dialect_);
    add("light", kNumbersType, 20 * kMillisecond, [message](const Simulation& now) -> Bytes {
      const vehicle::Light light = *now.vehicle()->light();
      return message->write(std::array{light.left_lux, light.right_lux});
    });
  }

  void add_lane() {
    const auto message = std::make_shared<NumbersMessage>(dialect_);
    add("lane", kNumbersType, 20 * kMillisecond, [message](const Simulation& now) -> Bytes {
      const vehicle::LanePosition position = *now.vehicle()->lane_position();
      return message->write(std::array{position.distance_m, position.angle_rad});
    });
  }

  void add_camera(const Simulation& robot, const pictures::CameraOptions& options, bool blind) {
    const TimeNs period = rounded(1 / options.rate_hz);
    pictures::camera_id(robot, options.name);  // also of a blind one
    const auto image = std::make_shared<ImageMessage>(dialect_);
    if (blind) {
      const auto size = static_cast<std::size_t>(options.size.width) * options.size.height;
      add("camera/image_raw", kImageType, period,
          [this, image, black = pictures::Image{options.size, std::vector<std::uint8_t>(3 * size)}](
              const Simulation& now) -> Bytes { return image->write(begin_ + now.time(), black); });
    } else {
      const auto camera = std::make_shared<pictures::Camera>(robot, options);
      add("camera/image_raw", kImageType, period,
          [this, image, camera](const Simulation& now) -> Bytes {
            return image->write(begin_ + now.time(), camera->look(now));
          });
    }
    const auto info = std::make_shared<CameraInfoMessage>(dialect_);
    add("camera/camera_info", kCameraInfoType, period,
        [this, info, options](const Simulation& now) -> Bytes {
          return info->write(begin_ + now.time(), options);
        });
  }

  messages::Dialect dialect_;
  TimeNs begin_ = 0;
  std::vector<SensorTopic> topics_;
  std::vector<Write> writers_;  // of each topic
  std::vector<TimeNs> next_;
};

Sensors::Sensors(const Simulation& robot, const SensorOptions& options)
    : impl_(std::make_unique<Impl>(robot, options)) {}
Sensors::~Sensors() = default;
Sensors::Sensors(Sensors&&) noexcept = default;
Sensors& Sensors::operator=(Sensors&&) noexcept = default;

void Sensors::begin_stamps(TimeNs stamp) {
  impl_->begin_stamps(stamp);
}
const std::vector<SensorTopic>& Sensors::topics() const {
  return impl_->topics();
}
void Sensors::add_numbers(const std::string& name, TimeNs period,
                          std::function<std::vector<double>()> numbers) {
  impl_->add_numbers(name, period, std::move(numbers));
}
std::span<const std::byte> Sensors::write(std::size_t index, const Simulation& robot) {
  return impl_->write(index, robot);
}
bool Sensors::due(std::size_t index, TimeNs time) {
  return impl_->due(index, time);
}
void Sensors::begin_anew() {
  impl_->begin_anew();
}

}  // namespace spikeloop::robot
