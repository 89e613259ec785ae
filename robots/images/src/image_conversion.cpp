#include "spikeloop/images/image_conversion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "area_average.hpp"
#include "centre_surround.hpp"
#include "decoders.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::images {
namespace {

/// Light below that part of the range is all alike when the intensity is logarithmic.
constexpr double kDark = 0.01;

/// An example for `range`, in the unit that such images usually have.
const char* example_range(const Encoding& encoding) {
  if (encoding.sample != Sample::f32 && encoding.sample != Sample::f64) {
    return "[300, 5000]";
  }
  return encoding.components == 1 ? "[0.3, 5]" : "[0, 1]";
}

}  // namespace

struct ImageConversion::Impl {
  explicit Impl(const ImageSettings& wanted)
      : settings(wanted), contrast(wanted.centre, wanted.surround) {}

  std::pair<double, double> range_of(const Encoding& encoding) const {
    if (settings.range) {
      return *settings.range;
    }
    if (encoding.greatest() == 0) {
      throw ConfigurationError(
          with_code(Code::field_path,
                    "images with the encoding {} have no range of their own; write the values that "
                    "become -1 and 1, as in  image: {{range: {}}}",
                    encoding.name, example_range(encoding)));
    }
    return {0, encoding.greatest()};
  }

  Crop crop_of(const ImageView& image) const {
    const Crop crop = settings.crop.value_or(Crop{0, 0, image.width, image.height});
    if (std::uint64_t{crop.x} + crop.width > image.width ||
        std::uint64_t{crop.y} + crop.height > image.height) {
      throw ConfigurationError(with_code(
          Code::out_of_bounds,
          "crop: [{}, {}, {}, {}] reaches beyond the image, which has {} x {} pixels; write a "
          "part within it",
          crop.x, crop.y, crop.width, crop.height, image.width, image.height));
    }
    return crop;
  }

  Size size_of(const Crop& crop) const {
    if (settings.resize) {
      return *settings.resize;
    }
    if (std::max(crop.width, crop.height) > kLongestSide) {
      throw ConfigurationError(with_code(
          Code::out_of_bounds,
          "a picture of {} x {} pixels is too large to take every one; write  resize: [40, 30]",
          crop.width, crop.height));
    }
    return {crop.width, crop.height};
  }

  void scale(double least, double most) {
    for (double& value : values) {
      if (std::isnan(value)) {
        continue;
      }
      value = std::clamp((value - least) / (most - least), 0.0, 1.0);
      if (settings.intensity == Intensity::log) {
        value = std::log1p(value / kDark) / std::log1p(1 / kDark);
      }
    }
  }

  void filter() {
    const std::size_t pixels = std::size_t{size.width} * size.height;
    const std::size_t planes = values.size() / pixels;
    if (settings.filter != Filter::none) {
      for (std::size_t plane = 0; plane < planes; ++plane) {
        contrast.filter(std::span(values).subspan(plane * pixels, pixels), size.width);
      }
    }
    if (settings.filter == Filter::centre_surround) {
      for (double& value : values) {
        value = limited(settings.gain * value);
      }
      return;
    }
    if (settings.filter == Filter::none) {
      for (double& value : values) {
        value = 2 * value - 1;
      }
      return;
    }
    halves.resize(2 * values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t on = i / pixels * 2 * pixels + i % pixels;
      const double value = settings.gain * values[i];
      halves[on] = half(value);
      halves[on + pixels] = half(-value);
    }
    values.swap(halves);
  }

  /// NaN stays NaN.
  static double limited(double value) {
    return std::isnan(value) ? value : std::clamp(value, -1.0, 1.0);
  }
  static double half(double value) { return limited(value < 0 ? -1.0 : 2 * value - 1); }

  std::span<const double> convert(const ImageView& image) {
    const Encoding encoding = check_image(image);
    const auto [least, most] = range_of(encoding);
    const Crop crop = crop_of(image);
    size = size_of(crop);
    average.average(image, encoding, crop, size, settings.channel, least, most, values);
    scale(least, most);
    filter();
    return values;
  }

  ImageSettings settings;
  AreaAverage average;
  CentreSurround contrast;
  Size size{};
  std::vector<double> values;
  std::vector<double> halves;
  std::vector<std::byte> decoded;
};

ImageConversion::ImageConversion(const ImageSettings& settings)
    : impl_(std::make_unique<Impl>(settings)) {}
ImageConversion::~ImageConversion() = default;
ImageConversion::ImageConversion(ImageConversion&&) noexcept = default;
ImageConversion& ImageConversion::operator=(ImageConversion&&) noexcept = default;

std::span<const double> ImageConversion::convert(const ImageView& image) {
  return impl_->convert(image);
}

std::span<const double> ImageConversion::convert_compressed(std::span<const std::byte> data,
                                                            std::string_view format) {
  const bool colour = impl_->settings.channel != Channel::grey;
  return impl_->convert(decode_compressed(data, format, colour, impl_->decoded));
}

const ImageSettings& ImageConversion::settings() const {
  return impl_->settings;
}

Size ImageConversion::size() const {
  return impl_->size;
}

}  // namespace spikeloop::images
