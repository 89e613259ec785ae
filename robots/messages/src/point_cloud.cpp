#include "point_cloud.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>

#include "header.hpp"
#include "path_walk.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::messages {
namespace {

constexpr std::string_view kBegin = "points.";

struct PointField {
  std::string_view name;
  std::uint32_t offset = 0;
  std::uint32_t datatype = 0;
};

struct Cloud {
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<PointField> fields;
  bool big_endian = false;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;
  std::span<const std::byte> data;
};

Cloud read_cloud(Dialect dialect, std::span<const std::byte> message) {
  return with_reader(dialect, message, [&](auto& reader) {
    constexpr std::size_t kLeastField = 13;  // a text, three numbers
    skip_header(reader, dialect);
    Cloud cloud;
    cloud.height = read_uint32(reader);
    cloud.width = read_uint32(reader);
    const std::size_t fields = reader.length(kLeastField);
    for (std::size_t i = 0; i < fields; ++i) {
      PointField field;
      field.name = reader.text();
      field.offset = read_uint32(reader);
      field.datatype = static_cast<std::uint32_t>(reader.number(Primitive::uint8));
      read_uint32(reader);  // how many there are: the first is taken
      cloud.fields.push_back(field);
    }
    cloud.big_endian = reader.number(Primitive::uint8) != 0;
    cloud.point_step = read_uint32(reader);
    cloud.row_step = read_uint32(reader);
    cloud.data = read_bytes(reader);
    return cloud;
  });
}

template <typename T>
double number_at(const std::byte* at, bool big_endian) {
  return static_cast<double>(load<T>(at, big_endian));
}

struct Datatype {
  std::uint32_t size;
  double (*load)(const std::byte* at, bool big_endian);
};

/// sensor_msgs/PointField's numbers from 1, INT8, to 8, FLOAT64.
constexpr Datatype kDatatypes[] = {{1, number_at<std::int8_t>},  {1, number_at<std::uint8_t>},
                                   {2, number_at<std::int16_t>}, {2, number_at<std::uint16_t>},
                                   {4, number_at<std::int32_t>}, {4, number_at<std::uint32_t>},
                                   {4, number_at<float>},        {8, number_at<double>}};

const PointField& find_field(const Cloud& cloud, std::string_view name) {
  const auto found = std::ranges::find(cloud.fields, name, &PointField::name);
  if (found == cloud.fields.end()) {
    std::vector<std::string> names;
    for (const PointField& field : cloud.fields) {
      names.emplace_back(field.name);
    }
    throw TransportError(with_code(Code::damaged_message, "its points have no '{}'{}", name,
                                   did_you_mean(name, names)));
  }
  return *found;
}

const Datatype& check_cloud(const Cloud& cloud, const PointField& field) {
  if (field.datatype == 0 || field.datatype > std::size(kDatatypes)) {
    throw TransportError(with_code(Code::damaged_message,
                                   "its '{}' has datatype {}; PointField has 1 to {}", field.name,
                                   field.datatype, std::size(kDatatypes)));
  }
  const Datatype& type = kDatatypes[field.datatype - 1];
  if (std::uint64_t{field.offset} + type.size > cloud.point_step) {
    throw TransportError(with_code(Code::damaged_message,
                                   "its '{}' at byte {} lies outside of points of {} bytes",
                                   field.name, field.offset, cloud.point_step));
  }
  const std::uint64_t row = std::uint64_t{cloud.width} * cloud.point_step;
  if (cloud.height > 1 && cloud.row_step < row) {
    throw TransportError(with_code(Code::damaged_message,
                                   "its rows of {} bytes are shorter than {} points of {} bytes",
                                   cloud.row_step, cloud.width, cloud.point_step));
  }
  if (cloud.height > 0 &&
      std::uint64_t{cloud.height - 1} * cloud.row_step + row > cloud.data.size()) {
    throw TransportError(with_code(Code::damaged_message,
                                   "it has {} bytes, less than {} x {} points of {} bytes",
                                   cloud.data.size(), cloud.width, cloud.height, cloud.point_step));
  }
  return type;
}

}  // namespace

std::optional<PointPath> PointPath::parse(std::string_view text) {
  if (!text.starts_with(kBegin)) {
    return std::nullopt;
  }
  PointPath path;
  path.text_ = text;
  const std::string_view rest = text.substr(kBegin.size());
  const auto bracket = rest.find('[');
  path.field_ = rest.substr(0, bracket);
  const auto fail = [&] {
    throw ConfigurationError(with_code(
        Code::field_path,
        "field path '{}' of {}: it selects nothing; write points.NAME, points.NAME[index] or "
        "points.NAME[first:end]",
        text, kPointCloud));
  };
  if (path.field_.empty()) {
    fail();
  }
  if (bracket == std::string_view::npos) {
    return path;
  }
  if (!rest.ends_with(']')) {
    fail();
  }
  const auto elements = parse_elements(rest.substr(bracket + 1, rest.size() - bracket - 2));
  if (!elements || elements->last <= elements->first) {
    fail();
  }
  if (elements->is_too_far()) {
    throw ConfigurationError(
        with_code(Code::field_path,
                  "field path '{}' of {}: '{}' reaches beyond the first {} elements; no path takes "
                  "more",
                  text, kPointCloud, rest.substr(bracket), kMostElements));
  }
  path.first_ = elements->first;
  if (elements->has_end) {
    path.last_ = elements->last;
  }
  return path;
}

std::optional<std::size_t> PointPath::width() const {
  return last_ ? std::optional(*last_ - first_) : std::nullopt;
}

std::size_t PointPath::read(Dialect dialect, std::span<const std::byte> message,
                            std::vector<double>& values) const {
  const Cloud cloud = read_cloud(dialect, message);
  const PointField& field = find_field(cloud, field_);
  const Datatype& type = check_cloud(cloud, field);
  const std::size_t points = std::size_t{cloud.width} * cloud.height;
  const std::size_t last = std::min(points, last_.value_or(points));
  const std::size_t before = values.size();
  for (std::size_t i = first_; i < last; ++i) {
    const std::size_t row = i / cloud.width * cloud.row_step;
    const std::byte* const point = cloud.data.data() + row + i % cloud.width * cloud.point_step;
    values.push_back(type.load(point + field.offset, cloud.big_endian));
  }
  return values.size() - before;
}

}  // namespace spikeloop::messages
