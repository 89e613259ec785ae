#include "area_average.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>

#include "row_reader.hpp"

namespace spikeloop::images {
namespace {

/// How a plane is made of a pixel's components.
using Mixture = std::vector<float>;

std::vector<Mixture> mixtures(const Encoding& encoding, Channel channel) {
  constexpr float kGrey[] = {0.299F, 0.587F, 0.114F};  // BT.601
  const auto only = [&](std::size_t colour) {
    Mixture mixture(encoding.components, 0.0F);
    // In a grey image every colour has the grey value. Rows of YUV and Bayer are read as rgb.
    const bool reordered = encoding.layout == Layout::plain && encoding.components > 1;
    const std::size_t place = encoding.components == 1 ? 0
                              : reordered              ? encoding.rgb[colour]
                                                       : colour;
    mixture[place] = 1.0F;
    return mixture;
  };
  switch (channel) {
    case Channel::red:
      return {only(0)};
    case Channel::green:
      return {only(1)};
    case Channel::blue:
      return {only(2)};
    case Channel::rgb:
      return {only(0), only(1), only(2)};
    case Channel::grey:
      break;
  }
  if (encoding.components == 1) {
    return {only(0)};
  }
  Mixture grey(encoding.components, 0.0F);
  for (std::size_t colour = 0; colour < 3; ++colour) {
    const Mixture one = only(colour);
    for (std::size_t i = 0; i < grey.size(); ++i) {
      grey[i] += kGrey[colour] * one[i];
    }
  }
  return {grey};
}

/// Large numbers are limited to those of a float.
float to_float(double value) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(value, -kMost, kMost));
}
template <typename T>
float to_float(T value) {
  return static_cast<float>(value);
}

template <typename T>
void add_row(const T* row, std::size_t count, float weight, float* sum) {
  if (weight == 1.0F) {
    for (std::size_t i = 0; i < count; ++i) {
      sum[i] += to_float(row[i]);
    }
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    sum[i] += weight * to_float(row[i]);
  }
}

/// Adds depths. NaN, and 0 of 16UC1, are not readings.
template <typename T>
void add_readings(std::span<const T> row, float weight, float least, float most, float* sum,
                  float* weights) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    const float value = to_float(row[i]);
    const bool reading = std::is_same_v<T, std::uint16_t> ? value != 0.0F : !std::isnan(value);
    const float part = reading ? weight : 0.0F;
    sum[i] += reading ? part * std::clamp(value, least, most) : 0.0F;
    weights[i] += part;
  }
}

double sum_over(const Reach& reach, const std::vector<float>& values) {
  double sum = static_cast<double>(reach.first_weight) * static_cast<double>(values[reach.first]);
  for (std::uint32_t x = reach.first + 1; x < reach.last; ++x) {
    sum += static_cast<double>(values[x]);
  }
  if (reach.last != reach.first) {
    sum += static_cast<double>(reach.last_weight) * static_cast<double>(values[reach.last]);
  }
  return sum;
}

double length(const Reach& reach) {
  double sum = static_cast<double>(reach.first_weight);
  if (reach.last != reach.first) {
    sum += reach.last - reach.first - 1 + static_cast<double>(reach.last_weight);
  }
  return sum;
}

}  // namespace

std::vector<Reach> reaches(std::uint32_t size, std::uint32_t count) {
  std::vector<Reach> result;
  for (std::uint64_t i = 0; i < count; ++i) {
    // In whole numbers: count parts make a pixel.
    const std::uint64_t begin = i * size;
    const std::uint64_t end = (i + 1) * size;
    Reach reach;
    reach.first = static_cast<std::uint32_t>(begin / count);
    reach.last = static_cast<std::uint32_t>((end - 1) / count);
    const double parts = count;
    const double of_first =
        static_cast<double>(std::min<std::uint64_t>(end, (begin / count + 1) * count) - begin);
    const double of_last = static_cast<double>(end - (end - 1) / count * count);
    reach.first_weight = static_cast<float>(of_first / parts);
    reach.last_weight = static_cast<float>(of_last / parts);
    result.push_back(reach);
  }
  return result;
}

void AreaAverage::prepare(const Crop& crop, Size size) {
  if (crop.width != crop_.width || crop.height != crop_.height || size.width != size_.width ||
      size.height != size_.height) {
    columns_ = reaches(crop.width, size.width);
    rows_ = reaches(crop.height, size.height);
  }
  crop_ = crop;
  size_ = size;
}

void AreaAverage::average(const ImageView& image, const Encoding& encoding, const Crop& crop,
                          Size size, Channel channel, double least, double most,
                          std::vector<double>& values) {
  prepare(crop, size);
  Encoding read = encoding;
  if (encoding.is_yuv() && channel == Channel::grey) {
    read.components = 1;  // The luma is the grey.
  }
  const std::vector<Mixture> planes = mixtures(read, channel);
  values.resize(planes.size() * size.width * size.height);
  with_sample(encoding.sample, [&]<typename T>(T /*sample*/) {
    average_rows<T>(image, read, crop, planes, least, most, values);
  });
}

template <typename T>
void AreaAverage::average_rows(const ImageView& image, const Encoding& encoding, const Crop& crop,
                               const std::vector<Mixture>& planes, double least, double most,
                               std::vector<double>& values) {
  RowReader<T> reader(image, encoding);
  const std::size_t components = encoding.components;
  const std::size_t samples = crop.width * components;
  for (std::uint32_t y = 0; y < size_.height; ++y) {
    sum_.assign(samples, 0.0F);
    weight_.assign(encoding.depth ? samples : 0, 0.0F);
    const Reach& reach = rows_[y];
    for (std::uint32_t source = reach.first; source <= reach.last; ++source) {
      const auto row = reader.row(crop.y + source).subspan(crop.x * components, samples);
      const float weight = reach.weight(source);
      if (encoding.depth) {
        add_readings<T>(row, weight, static_cast<float>(least), static_cast<float>(most),
                        sum_.data(), weight_.data());
      } else {
        add_row(row.data(), samples, weight, sum_.data());
      }
    }
    put_row(y, encoding, crop.width, planes, values);
  }
}

void AreaAverage::put_row(std::uint32_t y, const Encoding& encoding, std::uint32_t width,
                          const std::vector<Mixture>& planes, std::vector<double>& values) {
  const std::size_t components = encoding.components;
  double* out = values.data() + std::size_t{y} * size_.width;
  for (const Mixture& mixture : planes) {
    light_.assign(width, 0.0F);
    for (std::size_t c = 0; c < components; ++c) {
      for (std::size_t x = 0; mixture[c] != 0.0F && x < width; ++x) {
        light_[x] += mixture[c] * sum_[x * components + c];
      }
    }
    const double rows = length(rows_[y]);
    for (std::uint32_t x = 0; x < size_.width; ++x) {
      const double area =
          encoding.depth ? sum_over(columns_[x], weight_) : rows * length(columns_[x]);
      out[x] = area > 0 ? sum_over(columns_[x], light_) / area
                        : std::numeric_limits<double>::quiet_NaN();
    }
    out += std::size_t{size_.width} * size_.height;
  }
}

}  // namespace spikeloop::images
