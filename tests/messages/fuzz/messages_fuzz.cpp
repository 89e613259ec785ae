// Bytes of messages under libFuzzer (scripts/fuzz). The first byte says the type and the dialect,
// the rest is the message: whatever it is, a field has values or there is a TransportError, nothing
// lies outside of the bytes, and what was read can be written and read again.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/columns.hpp"
#include "spikeloop/messages/event_conversion.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"

using namespace spikeloop;
using namespace spikeloop::messages;

namespace {

using Bytes = std::span<const std::byte>;

void need(bool condition) {
  if (!condition) {
    std::abort();
  }
}

bool is_inside(Bytes message, const void* begin, std::size_t size) {
  const auto* const at = static_cast<const std::byte*>(begin);
  return size == 0 || (at >= message.data() && at + size <= message.data() + message.size());
}

/// Everything that can be asked of one type.
struct Subject {
  const char* type;
  std::vector<std::string> numbers;
  std::vector<std::string> texts;
};

const std::vector<Subject>& subjects() {
  static const std::vector<Subject> all = {
      {"sensor_msgs/LaserScan", {"header.stamp", "ranges", "ranges[2:5]"}, {"header.frame_id"}},
      {"sensor_msgs/JointState",
       {"position[name=a]", "velocity[name=b]", "position"},
       {"name", "name[1]"}},
      {"tf2_msgs/TFMessage",
       {"transforms[child_frame_id=a].transform.rotation.w", "transforms.header.stamp.secs",
        "transforms[1].transform.translation.x"},
       {"transforms.child_frame_id"}},
      {"sensor_msgs/PointCloud2",
       {"height", "fields.offset", "is_dense", "fields[name=x].offset"},
       {"fields.name"}},
      {"sensor_msgs/Image", {"height", "step"}, {"encoding"}},
      {"std_msgs/Float64MultiArray", {"data", "layout.dim.size"}, {"layout.dim.label"}},
      {"trajectory_msgs/MultiDOFJointTrajectory",
       {"points.transforms.rotation.w", "points[0].time_from_start", "points.velocities.linear.x"},
       {"joint_names"}},
      {"event_camera_msgs/EventPacket", {"seq", "time_base"}, {"encoding"}},
      {"dvs_msgs/EventArray", {"events.ts", "events.polarity", "height"}, {}},
      {"nav_msgs/Odometry", {"pose.covariance", "twist.twist.angular.z"}, {"child_frame_id"}},
  };
  return all;
}

/// What came out goes in again and comes out the same, where the path can be written.
void check_round_trip(const Catalog& catalog, const char* type, const std::string& path,
                      const std::vector<double>& numbers) {
  const FieldValue value{numbers, {}};
  std::vector<std::byte> message;
  try {
    MessageWriter(catalog, type, {path}).write(std::span(&value, 1), message);
  } catch (const ConfigurationError&) {
    return;  // the message has fewer elements than the path names, or any number
  }
  std::vector<double> again;
  FieldReader(catalog, type, path).read(message, again);
  need(again.size() == numbers.size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    need(again[i] == numbers[i] || (std::isnan(again[i]) && std::isnan(numbers[i])) ||
         std::abs(again[i] - numbers[i]) <= 1e-6 * (1 + std::abs(numbers[i])));
  }
}

void check_fields(const Catalog& catalog, const Subject& subject, Bytes message) {
  for (const std::string& path : subject.numbers) {
    std::vector<double> numbers;
    try {
      FieldReader(catalog, subject.type, path).read(message, numbers);
    } catch (const TransportError&) {
      continue;
    }
    need(numbers.size() <= message.size());
    check_round_trip(catalog, subject.type, path, numbers);
  }
  for (const std::string& path : subject.texts) {
    std::vector<std::string_view> texts;
    try {
      TextField(catalog, subject.type, path).read(message, texts);
    } catch (const TransportError&) {
    }
    for (const std::string_view text : texts) {
      need(is_inside(message, text.data(), text.size()));
    }
  }
}

/// All fields at once: every value is from the bytes.
void check_columns(const Catalog& catalog, const Subject& subject, Bytes message) {
  ColumnReader reader(catalog.layout(subject.type));
  bool good = true;
  try {
    reader.read(message);
  } catch (const TransportError&) {
    good = false;
  }
  std::size_t bytes = 0;
  for (const Column& column : reader.take_columns()) {
    bytes += column.numbers.size();
    for (const std::string& text : column.texts) {
      bytes += text.size() + 4;
    }
    need(!good || column.counts.size() != 1 || column.counts.front().size() == 1);
  }
  need(bytes <= message.size());
}

void check_conversions(const Catalog& catalog, const Subject& subject, Bytes message) {
  const std::string_view type = subject.type;
  if (type == "sensor_msgs/LaserScan" || type == "nav_msgs/Odometry" ||
      type == "std_msgs/Float64MultiArray") {
    SensorConversion conversion(catalog, type, {}, 3, false);
    conversion.convert(message);
    need(conversion.channels().size() == 3);
  }
  if (type == "sensor_msgs/LaserScan") {
    SensorConversion resampled(
        catalog, type, {.scan = ScanRule{.beams = 9, .angles = std::pair(-1.0, 5.0)}}, 9, false);
    resampled.convert(message);
  }
  if (type == "sensor_msgs/JointState") {
    SensorConversion joints(catalog, type, plain_fields({"position", "velocity"}), 7, false);
    joints.convert(message);
    joints.convert(message);
  }
  if (type == "dvs_msgs/EventArray") {
    EventConversion conversion({.width = 8}, catalog.dialect());
    EventMessage events;
    try {
      conversion.convert(message, events);
    } catch (const ConfigurationError&) {
    }
    for (const Spike& event : events.events) {
      need(event.channel >= 0 && event.channel < 8);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  const Dialect dialect = (data[0] & 1) == 0 ? Dialect::ros1 : Dialect::ros2;
  const Subject& subject = subjects()[data[0] / 2 % subjects().size()];
  // A copy of exactly this size, so that whatever lies behind it is not the message's.
  const std::vector<std::uint8_t> exact(data + 1, data + size);
  const Bytes message = std::as_bytes(std::span(exact));
  const Catalog& catalog = Catalog::builtin(dialect);
  check_fields(catalog, subject, message);
  check_columns(catalog, subject, message);
  check_conversions(catalog, subject, message);
  return 0;
}
