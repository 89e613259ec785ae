#include "reading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "field_reading.hpp"
#include "header.hpp"
#include "scan_reading.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/images/image_conversion.hpp"

namespace spikeloop::messages {
namespace {

constexpr std::string_view kImage = "sensor_msgs/Image";
constexpr std::string_view kCompressedImage = "sensor_msgs/CompressedImage";

/// Views of a message's bytes.
struct CompressedImage {
  std::string_view format;
  std::span<const std::byte> data;
};

images::ImageView read_image(Dialect dialect, std::span<const std::byte> message) {
  return with_reader(dialect, message, [&](auto& reader) {
    skip_header(reader, dialect);
    images::ImageView image;
    image.height = read_uint32(reader);
    image.width = read_uint32(reader);
    image.encoding = reader.text();
    image.big_endian = reader.number(Primitive::uint8) != 0;
    image.step = read_uint32(reader);
    image.data = read_bytes(reader);
    return image;
  });
}

CompressedImage read_compressed_image(Dialect dialect, std::span<const std::byte> message) {
  return with_reader(dialect, message, [&](auto& reader) {
    skip_header(reader, dialect);
    CompressedImage image;
    image.format = reader.text();
    image.data = read_bytes(reader);
    return image;
  });
}

class PictureReading : public Reading {
 public:
  PictureReading(Dialect dialect, bool compressed, const images::ImageSettings& settings)
      : dialect_(dialect), compressed_(compressed), conversion_(settings) {}

  std::optional<std::size_t> width() const override { return conversion_.settings().values(); }
  std::string name_of(std::size_t channel) const override {
    const images::Size size = conversion_.size();
    const std::size_t pixels = std::max<std::size_t>(std::size_t{size.width} * size.height, 1);
    return fmt::format("pixel ({}, {})", channel % pixels % std::max(size.width, 1U),
                       channel % pixels / std::max(size.width, 1U));
  }

  std::string length_remedy(std::size_t /*channels*/) const override {
    return "give images of several sizes one size, as in  image: {resize: [32, 24]}";
  }

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
    fields.resize(width == 0 ? fields.size() : std::min<std::size_t>(fields.size(), width));
    return fields;
  }
  throw ConfigurationError(
      with_code(Code::field_path,
                "message type {0} has no default fields; list them, as in  fields: [PATH, PATH] "
                "('spikeloop describe {0}' prints the paths)",
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
  if (rule.scan && type != kLaserScan) {
    throw ConfigurationError(
        with_code(Code::field_path, "'beams', 'angles' and 'range' are for {}, not for {}; {}",
                  kLaserScan, type,
                  picture ? "write the range of an image as  image: {range: [300, 5000]}"
                          : "leave them out, and write in 'fields' the fields to take"));
  }
  if (!rule.fields.empty()) {
    return std::make_unique<FieldReading>(catalog, type, rule.fields, width);
  }
  if (picture) {
    return std::make_unique<PictureReading>(catalog.dialect(), type == kCompressedImage,
                                            rule.image.value_or(images::ImageSettings{}));
  }
  if (type == kLaserScan) {
    return std::make_unique<ScanReading>(catalog, rule.scan.value_or(ScanRule{}));
  }
  return std::make_unique<FieldReading>(catalog, type, usual_fields(type, width), width);
}

}  // namespace spikeloop::messages
