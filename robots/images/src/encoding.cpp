#include "encoding.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/images/image_conversion.hpp"

namespace spikeloop::images {
namespace {

constexpr std::array<std::uint8_t, 3> kRgb{0, 1, 2};
constexpr std::array<std::uint8_t, 3> kBgr{2, 1, 0};

// A Bayer cell's `rgb`: where its red pixel lies (0 to 3, row by row), the two green ones, blue.
constexpr Encoding kEncodings[] = {
    {"mono8"},
    {"8UC1"},
    {"mono16", Layout::plain, Sample::u16},
    {"16UC1", Layout::plain, Sample::u16, 1, {}, true},
    {"32FC1", Layout::plain, Sample::f32, 1, {}, true},
    {"rgb8", Layout::plain, Sample::u8, 3, kRgb},
    {"bgr8", Layout::plain, Sample::u8, 3, kBgr},
    {"rgba8", Layout::plain, Sample::u8, 4, kRgb},
    {"bgra8", Layout::plain, Sample::u8, 4, kBgr},
    {"yuv422", Layout::uyvy, Sample::u8, 3, kRgb},
    {"uyvy", Layout::uyvy, Sample::u8, 3, kRgb},
    {"yuv422_yuy2", Layout::yuyv, Sample::u8, 3, kRgb},
    {"yuyv", Layout::yuyv, Sample::u8, 3, kRgb},
    {"bayer_rggb8", Layout::bayer, Sample::u8, 3, {0, 1, 3}},
    {"bayer_bggr8", Layout::bayer, Sample::u8, 3, {3, 1, 0}},
    {"bayer_gbrg8", Layout::bayer, Sample::u8, 3, {2, 0, 1}},
    {"bayer_grbg8", Layout::bayer, Sample::u8, 3, {1, 0, 2}},
};

}  // namespace

std::size_t Encoding::pixel_bytes() const {
  switch (layout) {
    case Layout::uyvy:
    case Layout::yuyv:
      return 2;
    case Layout::bayer:
      return 1;
    default:
      return components * (sample == Sample::u8 ? 1U : sample == Sample::u16 ? 2U : 4U);
  }
}

double Encoding::greatest() const {
  return depth ? 0 : sample == Sample::u8 ? 255 : 65'535;
}

const Encoding& encoding_named(std::string_view name) {
  const auto* const found = std::ranges::find(kEncodings, name, &Encoding::name);
  if (found == std::end(kEncodings)) {
    std::vector<std::string_view> names;
    for (const Encoding& encoding : kEncodings) {
      names.push_back(encoding.name);
    }
    throw TransportError(with_code(Code::damaged_message,
                                   "its encoding '{}' is not known; let the driver send one of {}",
                                   name.substr(0, 40), fmt::join(names, ", ")));
  }
  return *found;
}

const Encoding& check_image(const ImageView& image) {
  const Encoding& encoding = encoding_named(image.encoding);
  const std::uint64_t width = image.width;
  const std::uint64_t height = image.height;
  if (width == 0 || height == 0 || width * height > kMostPixels) {
    throw TransportError(with_code(Code::damaged_message,
                                   "it has {} x {} pixels; 1 to {} in all can be used", width,
                                   height, kMostPixels));
  }
  const std::uint64_t row = width * encoding.pixel_bytes();
  if (image.step < row) {
    throw TransportError(with_code(Code::damaged_message,
                                   "its step of {} bytes is less than a row of {} pixels {}, {}",
                                   image.step, width, encoding.name, row));
  }
  if ((height - 1) * image.step + row > image.data.size()) {
    throw TransportError(with_code(Code::damaged_message,
                                   "it has {} bytes, less than {} rows of {}", image.data.size(),
                                   height, image.step));
  }
  const bool in_pairs = encoding.layout == Layout::uyvy || encoding.layout == Layout::yuyv;
  const bool in_cells = encoding.layout == Layout::bayer;
  if ((in_pairs && width % 2 != 0) || (in_cells && (width < 2 || height < 2))) {
    throw TransportError(with_code(
        Code::damaged_message, "a picture {} has no {} x {} pixels; its pixels come in {}",
        encoding.name, width, height, in_pairs ? "pairs" : "cells of 2 x 2"));
  }
  return encoding;
}

}  // namespace spikeloop::images
