#include "spikeloop/messages/sensor_conversion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "spikeloop/core/error.hpp"

namespace spikeloop::messages {
namespace {

std::vector<std::string> default_fields(const std::string& type, std::uint32_t width) {
  if (type == "sensor_msgs/LaserScan") {
    return {"range_min", "range_max", "ranges"};
  }
  if (type == "geometry_msgs/Twist") {
    return {"linear.x", "angular.z"};
  }
  if (type == "std_msgs/Float64MultiArray") {
    return {"data"};
  }
  if (type == "nav_msgs/Odometry") {
    std::vector<std::string> fields = {"pose.pose.position.x", "pose.pose.position.y",
                                       "pose.pose.position.z"};
    fields.resize(std::min<std::size_t>(fields.size(), width));
    return fields;
  }
  throw ConfigurationError(
      fmt::format("message type {} has no rule of its own that makes channels of it; write "
                  "fields=PATH,PATH,... with the fields to take",
                  type));
}

}  // namespace

SensorConversion::SensorConversion(const Catalog& catalog, std::string_view type,
                                   const std::vector<std::string>& fields, std::uint32_t width,
                                   bool strict)
    : type_(catalog.full_name(type)),
      strict_(strict),
      channels_(width, std::numeric_limits<double>::quiet_NaN()) {
  if (fields.empty() && type_ == "sensor_msgs/LaserScan") {
    rule_ = Rule::scan;
  } else if (fields.empty() && type_ == "geometry_msgs/Twist") {
    rule_ = Rule::limited;
  }
  std::optional<std::size_t> known = 0;
  for (const std::string& path : fields.empty() ? default_fields(type_, width) : fields) {
    readers_.emplace_back(catalog, type_, path);
    const auto count = readers_.back().path().width();
    known = known && count ? std::optional(*known + *count) : std::nullopt;
  }
  if (strict && known && *known != width) {
    throw ConfigurationError(
        fmt::format("a {} gives {} values, but the port has {} channels; write "
                    "[{}] in its connection",
                    type_, *known, width, *known));
  }
}

bool SensorConversion::convert(std::span<const std::byte> message) {
  ++counts_.messages;
  try {
    read_values(message);
  } catch (const TransportError& error) {
    if (counts_.malformed++ == 0) {
      warning_ = fmt::format("a {} could not be read and is left out: {}", type_, error.what());
    }
    return false;
  }
  if (rule_ == Rule::limited) {
    for (double& value : values_) {
      value = std::clamp(value, -1.0, 1.0);
    }
  }
  fit(values_.size());
  const std::size_t count = std::min(values_.size(), channels_.size());
  std::size_t readings = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool missing = std::ranges::binary_search(missing_, i);
    if (missing || (rule_ == Rule::scan && std::isnan(values_[i]))) {
      counts_.invalid_readings += missing ? 0 : 1;
    } else {
      channels_[i] = values_[i];
      ++readings;
    }
  }
  if (readings == 0 && counts_.without_reading++ == 0) {
    warning_ = fmt::format("a {} brought no reading; the channels keep what they had", type_);
  }
  return readings > 0;
}

void SensorConversion::read_values(std::span<const std::byte> message) {
  values_.clear();
  missing_.clear();
  for (const FieldReader& reader : readers_) {
    std::size_t count = reader.read(message, values_);
    // What the message does not have must not move the values behind it to other channels.
    for (const std::size_t width = reader.path().width().value_or(0); count < width; ++count) {
      missing_.push_back(values_.size());
      values_.push_back(std::numeric_limits<double>::quiet_NaN());
    }
  }
  if (rule_ == Rule::scan) {
    const double range_min = values_[0];
    const double range_max = values_[1];
    if (!std::isfinite(range_min) || !std::isfinite(range_max) || range_max <= range_min) {
      throw TransportError(fmt::format(
          "its range_min {} and range_max {} leave no range between them; the driver must set both",
          range_min, range_max));
    }
    values_.erase(values_.begin(), values_.begin() + 2);
    scale_scan(range_min, range_max);
  }
}

void SensorConversion::scale_scan(double range_min, double range_max) {
  for (double& value : values_) {
    if (value == 0.0 || std::isnan(value)) {
      value = std::numeric_limits<double>::quiet_NaN();
    } else if (value < range_min) {
      value = -1.0;
    } else if (value >= range_max) {
      value = 1.0;
    } else {
      value = 2.0 * (value - range_min) / (range_max - range_min) - 1.0;
    }
  }
}

void SensorConversion::fit(std::size_t count) {
  const std::size_t width = channels_.size();
  if (count == width || count == 0) {
    return;
  }
  if (strict_) {
    throw ConfigurationError(
        fmt::format("a {} brought {} values, but the port has {} channels; write [{}] in its "
                    "connection",
                    type_, count, width, count));
  }
  if (count > width) {
    if (counts_.cropped++ == 0) {
      warning_ = fmt::format(
          "a {} brought {} values, but the port has {} channels: the last {} are "
          "left out; write [{}] in its connection to have all",
          type_, count, width, count - width, count);
    }
  } else if (counts_.short_messages++ == 0) {
    warning_ = fmt::format(
        "a {} brought {} values, but the port has {} channels: the last {} keep "
        "their value; write [{}] in its connection",
        type_, count, width, width - count, count);
  }
}

std::string SensorConversion::take_warning() {
  return std::exchange(warning_, {});
}

}  // namespace spikeloop::messages
