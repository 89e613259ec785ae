#include "encoding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/images/image_conversion.hpp"

namespace spikeloop::images {
namespace {

constexpr std::array<std::uint8_t, 3> kRgb{0, 1, 2};
constexpr std::array<std::uint8_t, 3> kBgr{2, 1, 0};

constexpr Encoding kEncodings[] = {
    {"mono8"},
    {"mono16", Layout::plain, Sample::u16},
    {"rgb8", Layout::plain, Sample::u8, 3, kRgb},
    {"bgr8", Layout::plain, Sample::u8, 3, kBgr},
    {"rgba8", Layout::plain, Sample::u8, 4, kRgb},
    {"bgra8", Layout::plain, Sample::u8, 4, kBgr},
    {"rgb16", Layout::plain, Sample::u16, 3, kRgb},
    {"bgr16", Layout::plain, Sample::u16, 3, kBgr},
    {"rgba16", Layout::plain, Sample::u16, 4, kRgb},
    {"bgra16", Layout::plain, Sample::u16, 4, kBgr},
    {"yuv422", Layout::uyvy, Sample::u8, 3, kRgb},
    {"uyvy", Layout::uyvy, Sample::u8, 3, kRgb},
    {"yuv422_yuy2", Layout::yuyv, Sample::u8, 3, kRgb},
    {"yuyv", Layout::yuyv, Sample::u8, 3, kRgb},
    {"nv12", Layout::nv12, Sample::u8, 3, kRgb},
    {"nv21", Layout::nv21, Sample::u8, 3, kRgb},
    {"nv24", Layout::nv24, Sample::u8, 3, kRgb},
    {"bayer_rggb8", Layout::bayer, Sample::u8, 3, {0, 1, 3}},
    {"bayer_bggr8", Layout::bayer, Sample::u8, 3, {3, 1, 0}},
    {"bayer_gbrg8", Layout::bayer, Sample::u8, 3, {2, 0, 1}},
    {"bayer_grbg8", Layout::bayer, Sample::u8, 3, {1, 0, 2}},
    {"bayer_rggb16", Layout::bayer, Sample::u16, 3, {0, 1, 3}},
    {"bayer_bggr16", Layout::bayer, Sample::u16, 3, {3, 1, 0}},
    {"bayer_gbrg16", Layout::bayer, Sample::u16, 3, {2, 0, 1}},
    {"bayer_grbg16", Layout::bayer, Sample::u16, 3, {1, 0, 2}},
};

/// OpenCV's types, such as 8UC3, in the order of Sample.
constexpr std::string_view kSamples[] = {"8U", "8S", "16U", "16S", "32S", "32F", "64F"};

/// Three and four components are blue, green and red, as OpenCV, cv_bridge and RViz assume. A type
/// without a number of components has one, as in cv_bridge.
std::optional<Encoding> opencv_type(std::string_view name) {
  const auto* const found = std::ranges::find_if(
      kSamples, [&](std::string_view sample) { return name.starts_with(sample); });
  if (found == std::end(kSamples)) {
    return std::nullopt;
  }
  const auto sample = static_cast<Sample>(found - std::begin(kSamples));
  std::string_view components = name.substr(found->size());
  components = components.empty() ? "C1" : components;
  std::uint8_t count = 0;
  const char* const end = components.data() + components.size();
  if (!components.starts_with('C') ||
      std::from_chars(components.data() + 1, end, count).ptr != end || count == 0) {
    return std::nullopt;
  }
  const bool is_colour = count == 3 || count == 4;
  return Encoding{name,
                  Layout::plain,
                  sample,
                  count,
                  is_colour ? kBgr : std::array<std::uint8_t, 3>{},
                  count == 1 && sample != Sample::u8};
}

bool has_colours(const Encoding& encoding) {
  return encoding.components == 1 || encoding.components == 3 || encoding.components == 4;
}

void check_layout(const ImageView& image, const Encoding& encoding) {
  const bool in_pairs = encoding.layout == Layout::uyvy || encoding.layout == Layout::yuyv;
  const bool in_cells = encoding.layout == Layout::bayer;
  if ((in_pairs && image.width % 2 != 0) || (in_cells && (image.width < 2 || image.height < 2))) {
    throw TransportError(with_code(
        Code::damaged_message, "{} x {} pixels cannot be encoded as {}; its pixels come in {}",
        image.width, image.height, encoding.name, in_pairs ? "pairs" : "cells of 2 x 2"));
  }
}

}  // namespace

std::size_t Encoding::sample_bytes() const {
  std::size_t bytes = 0;
  with_sample(sample, [&](auto value) { bytes = sizeof value; });
  return bytes;
}

std::size_t Encoding::pixel_bytes() const {
  if (layout == Layout::plain) {
    return components * sample_bytes();
  }
  return layout == Layout::uyvy || layout == Layout::yuyv ? 2 : sample_bytes();
}

double Encoding::greatest() const {
  return depth ? 0 : sample == Sample::u8 ? 255 : sample == Sample::u16 ? 65'535 : 0;
}

std::optional<Encoding> find_encoding(std::string_view name, bool any_components) {
  const auto* const found = std::ranges::find(kEncodings, name, &Encoding::name);
  if (found != std::end(kEncodings)) {
    return *found;
  }
  const std::optional<Encoding> type = opencv_type(name);
  return type && (any_components || has_colours(*type)) ? type : std::nullopt;
}

Planes planes_of(const ImageView& image, Layout layout) {
  const std::uint64_t width = image.width;
  const std::uint64_t height = image.height;
  const bool all_chroma = layout == Layout::nv24;
  const std::uint64_t row = all_chroma ? 2 * width : (width + 1) / 2 * 2;
  const std::uint64_t rows = all_chroma ? height : (height + 1) / 2;
  const std::uint64_t packed = width * height + row * rows;
  if (image.data.size() == packed) {
    return {width, width * height, row, packed};  // Some drivers count the chroma in the step, too.
  }
  const std::uint64_t stride = std::max(row, std::uint64_t{image.step} * (all_chroma ? 2 : 1));
  const std::uint64_t chroma = image.step * height;
  return {image.step, chroma, stride, chroma + (rows - 1) * stride + row};
}

void check_area(std::string_view what, std::uint64_t width, std::uint64_t height) {
  if (width == 0 || height == 0 || width * height > kMostPixels) {
    throw TransportError(with_code(Code::damaged_message,
                                   "{} has {} x {} pixels; 1 to {} in all can be used", what, width,
                                   height, kMostPixels));
  }
}

Encoding check_image(const ImageView& image, bool any_components) {
  const std::optional<Encoding> found = find_encoding(image.encoding, any_components);
  if (!found) {
    throw ConfigurationError(with_code(
        Code::image_encoding,
        "images with the encoding '{}' cannot be read; publish them as mono8, rgb8, bgr8, "
        "16UC1 or 32FC1 (docs/images.md lists all encodings)",
        image.encoding.substr(0, 40)));
  }
  const std::uint64_t width = image.width;
  const std::uint64_t height = image.height;
  check_area("it", width, height);
  const std::uint64_t row = width * found->pixel_bytes();
  if (image.step < row) {
    throw TransportError(with_code(
        Code::damaged_message,
        "its step is {} bytes, but a row of {} pixels with the encoding {} has {}; correct 'step'",
        image.step, width, found->name, row));
  }
  const bool planar = found->is_yuv() && found->pixel_bytes() == 1;
  const std::uint64_t needed =
      planar ? planes_of(image, found->layout).end : (height - 1) * image.step + row;
  if (image.data.size() < needed) {
    throw TransportError(
        with_code(Code::damaged_message,
                  "it has {} bytes; {} x {} pixels with the encoding {} and a step of {} have {}",
                  image.data.size(), width, height, found->name, image.step, needed));
  }
  check_layout(image, *found);
  return *found;
}

}  // namespace spikeloop::images
