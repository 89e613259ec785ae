#include "reading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "image_message.hpp"
#include "point_cloud.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/images/image_conversion.hpp"
#include "spikeloop/messages/field_path.hpp"

namespace spikeloop::messages {
namespace {

class FieldReading : public Reading {
 public:
  FieldReading(const Catalog& catalog, const std::string& type,
               const std::vector<SensorField>& fields)
      : dialect_(catalog.dialect()) {
    for (const SensorField& field : fields) {
      auto points = type == kPointCloud ? PointPath::parse(field.path) : std::nullopt;
      if (points) {
        entries_.push_back({field, std::move(*points)});
      } else {
        entries_.push_back({field, FieldReader(catalog, type, field.path)});
      }
    }
  }

  std::optional<std::size_t> width() const override {
    std::size_t sum = 0;
    for (const Entry& entry : entries_) {
      const auto width = width_of(entry);
      if (!width) {
        return std::nullopt;
      }
      sum += *width;
    }
    return sum;
  }

  std::string path_of(std::size_t channel) const override {
    for (const Entry& entry : entries_) {
      const std::size_t width = width_of(entry).value_or(channel + 1);
      if (channel < width) {
        return entry.field.path;
      }
      channel -= width;
    }
    return Reading::path_of(channel);
  }

  bool read(std::span<const std::byte> message, ReadValues& values) override {
    for (const Entry& entry : entries_) {
      const std::size_t first = values.numbers.size();
      const std::size_t count = read_entry(entry, message, values.numbers);
      values.held.resize(first + count, Held::no);
      // What the message does not have must not move the values behind it to other channels.
      const std::size_t width = std::max(count, width_of(entry).value_or(0));
      values.numbers.resize(first + width, std::numeric_limits<double>::quiet_NaN());
      values.held.resize(first + width, Held::missing);
      for (std::size_t i = first; i < values.numbers.size(); ++i) {
        if (values.held[i] == Held::no && !settle(entry.field, values.numbers[i], values.held[i])) {
          return false;
        }
      }
    }
    return true;
  }

 private:
  struct Entry {
    SensorField field;
    std::variant<FieldReader, PointPath> reader;
  };

  static std::optional<std::size_t> width_of(const Entry& entry) {
    const auto* const path = std::get_if<FieldReader>(&entry.reader);
    return path != nullptr ? path->path().width() : std::get<PointPath>(entry.reader).width();
  }

  std::size_t read_entry(const Entry& entry, std::span<const std::byte> message,
                         std::vector<double>& numbers) const {
    const auto* const path = std::get_if<FieldReader>(&entry.reader);
    return path != nullptr ? path->read(message, numbers)
                           : std::get<PointPath>(entry.reader).read(dialect_, message, numbers);
  }

  /// False: the message is to be left out.
  static bool settle(const SensorField& field, double& value, Held& held) {
    if (!std::isnan(value)) {
      value = std::clamp(field.scale * value + field.offset, field.minimum, field.maximum);
      return true;
    }
    if (field.not_a_number == NotANumber::number) {
      value = field.instead;
    }
    held = field.not_a_number == NotANumber::hold ? Held::no_reading : Held::no;
    return field.not_a_number != NotANumber::skip;
  }

  Dialect dialect_;
  std::vector<Entry> entries_;
};

class ScanReading : public Reading {
 public:
  explicit ScanReading(const Catalog& catalog)
      : least_(catalog, "sensor_msgs/LaserScan", "range_min"),
        most_(catalog, "sensor_msgs/LaserScan", "range_max"),
        ranges_(catalog, "sensor_msgs/LaserScan", "ranges") {}

  std::optional<std::size_t> width() const override { return std::nullopt; }

  bool read(std::span<const std::byte> message, ReadValues& values) override {
    limits_.clear();
    least_.read(message, limits_);
    most_.read(message, limits_);
    const double least = limits_[0];
    const double most = limits_[1];
    ranges_.read(message, values.numbers);
    if (!std::isfinite(least) || !std::isfinite(most) || most <= least) {
      throw TransportError(with_code(
          Code::damaged_message,
          "its range_min {} and range_max {} leave no range between them; the driver must set both",
          least, most));
    }
    for (double& value : values.numbers) {
      const bool reading = value != 0.0 && !std::isnan(value);
      values.held.push_back(reading ? Held::no : Held::no_reading);
      value = value < least   ? -1.0
              : value >= most ? 1.0
                              : 2.0 * (value - least) / (most - least) - 1.0;
    }
    return true;
  }

 private:
  FieldReader least_;
  FieldReader most_;
  FieldReader ranges_;
  std::vector<double> limits_;
};

class PictureReading : public Reading {
 public:
  PictureReading(Dialect dialect, bool compressed, const images::ImageSettings& settings)
      : dialect_(dialect), compressed_(compressed), conversion_(settings) {}

  std::optional<std::size_t> width() const override { return conversion_.settings().values(); }

  bool read(std::span<const std::byte> message, ReadValues& values) override {
    const auto made = convert(message);
    values.numbers.assign(made.begin(), made.end());
    for (const double value : made) {
      values.held.push_back(std::isnan(value) ? Held::no_reading : Held::no);
    }
    return true;
  }

 private:
  std::span<const double> convert(std::span<const std::byte> message) {
    if (!compressed_) {
      return conversion_.convert(read_image(dialect_, message));
    }
    const CompressedImage image = read_compressed_image(dialect_, message);
    return conversion_.convert_compressed(image.data, image.format);
  }

  Dialect dialect_;
  bool compressed_;
  images::ImageConversion conversion_;
};

/// What a type gives when nobody says what to take.
std::vector<SensorField> usual_fields(const std::string& type, std::uint32_t width) {
  if (type == "geometry_msgs/Twist") {
    return {{.path = "linear.x", .minimum = -1, .maximum = 1},
            {.path = "angular.z", .minimum = -1, .maximum = 1}};
  }
  if (type == "std_msgs/Float64MultiArray") {
    return {{.path = "data"}};
  }
  if (type == "nav_msgs/Odometry") {
    std::vector<SensorField> fields{{.path = "pose.pose.position.x"},
                                    {.path = "pose.pose.position.y"},
                                    {.path = "pose.pose.position.z"}};
    fields.resize(std::min<std::size_t>(fields.size(), width));
    return fields;
  }
  throw ConfigurationError(
      with_code(Code::field_path,
                "message type {} has no usual fields; write in 'fields' the paths of those to "
                "take",
                type));
}

}  // namespace

SensorRule plain_fields(const std::vector<std::string>& paths) {
  SensorRule rule;
  for (const std::string& path : paths) {
    rule.fields.push_back({.path = path});
  }
  return rule;
}

std::unique_ptr<Reading> make_reading(const Catalog& catalog, const std::string& type,
                                      const SensorRule& rule, std::uint32_t width) {
  const bool picture = type == kImage || type == kCompressedImage;
  if (rule.image && !picture) {
    throw ConfigurationError(
        with_code(Code::field_path,
                  "'image' is for {} and {}, not for {}; write 'fields' with the fields to take",
                  kImage, kCompressedImage, type));
  }
  if (!rule.fields.empty()) {
    return std::make_unique<FieldReading>(catalog, type, rule.fields);
  }
  if (picture) {
    return std::make_unique<PictureReading>(catalog.dialect(), type == kCompressedImage,
                                            rule.image.value_or(images::ImageSettings{}));
  }
  if (type == "sensor_msgs/LaserScan") {
    return std::make_unique<ScanReading>(catalog);
  }
  return std::make_unique<FieldReading>(catalog, type, usual_fields(type, width));
}

}  // namespace spikeloop::messages
