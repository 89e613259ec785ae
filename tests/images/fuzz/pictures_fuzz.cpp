// Pictures under libFuzzer (scripts/fuzz). The first byte says what is made of them and whether
// they are files, JPEG or PNG; else five more say what a sensor_msgs/Image says, and the rest are
// its bytes. Whatever they are, there are as many values as the size says, each in [-1, 1] or
// without a reading, or an error that says what is wrong.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <span>
#include <string_view>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/images/image_conversion.hpp"

using namespace spikeloop;
using namespace spikeloop::images;

namespace {

constexpr std::string_view kEncodings[] = {
    "mono8",        "8UC1",         "mono16",      "16UC1",       "32FC1",       "rgb8",
    "bgr8",         "rgba8",        "bgra8",       "yuv422",      "uyvy",        "yuv422_yuy2",
    "yuyv",         "bayer_rggb8",  "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8", "jpeg",
    "bayer_rggb16", "bayer_gbrg16", "rgb16",       "bgra16",      "nv12",        "nv21",
    "nv24",         "8SC1",         "16SC3",       "32SC1",       "64FC1",       "32FC4"};

/// Of files, by their first byte: what CompressedImage.format says.
constexpr std::string_view kFormats[] = {"",
                                         "bgr8; jpeg compressed bgr8",
                                         "16UC1; png compressed ",
                                         "bayer_grbg16; png compressed ",
                                         "16UC1; compressedDepth png",
                                         "32FC1; compressedDepth",
                                         "16UC1; compressedDepth rvl",
                                         "32FC1; compressedDepth rvl"};

void need(bool condition) {
  if (!condition) {
    std::abort();
  }
}

/// Of small results, so that an input takes no time.
ImageSettings settings_of(unsigned choice) {
  ImageSettings settings;
  settings.resize = Size{4, 3};
  if ((choice & 1U) != 0) {
    settings.crop = Crop{1, 2, 5, 3};
  }
  if ((choice & 2U) != 0) {
    settings.range = {0.5, 3};
  }
  settings.channel = static_cast<Channel>(choice / 4 % 5);
  settings.intensity = static_cast<Intensity>(choice / 20 % 2);
  settings.filter = static_cast<Filter>(choice / 40 % 3);
  return settings;
}

void check(const ImageConversion& conversion, std::span<const double> values) {
  const Size size = conversion.size();
  need(values.size() == std::size_t{size.width} * size.height * conversion.settings().planes());
  for (const double value : values) {
    need(std::isnan(value) || (value >= -1 && value <= 1));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kHead = 6;
  if (size < kHead) {
    return 0;
  }
  const bool is_file = data[0] >= 128;
  // A copy of exactly this size, so that whatever lies behind it is not the picture's.
  const std::vector<std::uint8_t> exact(data + (is_file ? 1 : kHead), data + size);
  const auto bytes = std::as_bytes(std::span(exact));
  ImageConversion conversion(settings_of(data[0] % 128));
  try {
    if (is_file) {
      check(conversion,
            conversion.convert_compressed(bytes, kFormats[data[0] / 8 % std::size(kFormats)]));
      return 0;
    }
    const ImageView image{.width = data[1],
                          .height = data[2],
                          .step = data[3] + 256U * (data[4] / 128U),
                          .encoding = kEncodings[data[4] % 128U % std::size(kEncodings)],
                          .big_endian = (data[5] & 1U) != 0,
                          .data = bytes};
    check(conversion, conversion.convert(image));
  } catch (const Error&) {
    // The picture is damaged, or does not go with the settings.
  }
  return 0;
}
