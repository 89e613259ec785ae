// The formats of sensor_msgs/CompressedImage, as image_transport's plug-ins write them: "ENCODING;
// CODEC compressed ENCODING" of compressed_image_transport, "ENCODING; compressedDepth CODEC" of
// compressed_depth_image_transport. Other programs write the codec alone.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "decoders.hpp"
#include "encoding.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::images {
namespace {

using Bytes = std::span<const std::byte>;

/// Bytes of compressed_depth_image_transport's ConfigHeader: an unused integer and two floats.
constexpr std::size_t kDepthHeader = 12;

struct Signature {
  std::string_view name;
  std::size_t at;
  std::string_view bytes;
};

/// Formats that other programs put into a CompressedImage.
constexpr Signature kUnreadable[] = {
    {"WebP", 8, "WEBP"},
    {"TIFF", 0, {"II*\0", 4}},
    {"TIFF", 0, {"MM\0*", 4}},
    {"BMP", 0, "BM"},
    {"GIF", 0, "GIF8"},
    {"JPEG 2000", 4, "jP  "},
    {"AVIF or HEIF", 4, "ftyp"},
    {"H.264 or H.265", 0, {"\0\0\0\1", 4}},
    {"H.264 or H.265", 0, {"\0\0\1", 3}},
    {"Ogg", 0, "OggS"},
};

bool has_bytes(Bytes data, std::size_t at, std::string_view bytes) {
  return data.size() >= at + bytes.size() &&
         std::memcmp(data.data() + at, bytes.data(), bytes.size()) == 0;
}

bool is_jpeg(Bytes data) {
  return has_bytes(data, 0, "\xff\xd8\xff");
}

bool contains(std::string_view text, std::string_view word) {
  return text.find(word) != std::string_view::npos;
}

/// "16UC1" of "16UC1; png compressed ".
std::string_view encoding_in(std::string_view format) {
  std::string_view name = format.substr(0, format.find(';'));
  while (name.ends_with(' ')) {
    name.remove_suffix(1);
  }
  return name;
}

[[noreturn]] void fail_format(std::string_view format, std::string_view what) {
  throw ConfigurationError(
      with_code(Code::image_encoding,
                "compressed images with the format '{}'{} cannot be read; publish JPEG, PNG or "
                "compressedDepth, or the images without compression",
                format.substr(0, 60), what));
}

/// Reports data without a known signature: damaged if `format` names a codec that can be read, else
/// unsupported.
[[noreturn]] void fail_data(Bytes data, std::string_view format) {
  if (data.empty()) {
    throw TransportError(with_code(Code::damaged_message,
                                   "it has no data, its format is '{}'; image_transport sends this "
                                   "if it cannot compress the image, such as distances as JPEG",
                                   format.substr(0, 60)));
  }
  for (const Signature& known : kUnreadable) {
    if (has_bytes(data, known.at, known.bytes)) {
      fail_format(format, fmt::format(" and data in {}", known.name));
    }
  }
  constexpr std::string_view kReadable[] = {"jpeg", "jpg", "JPEG",           "JPG",
                                            "png",  "PNG", "compressedDepth"};
  if (std::ranges::none_of(kReadable,
                           [&](std::string_view codec) { return contains(format, codec); })) {
    fail_format(format, "");
  }
  throw TransportError(with_code(Code::damaged_message,
                                 "its {} bytes begin neither as a JPEG nor as a PNG; its format is "
                                 "'{}'",
                                 data.size(), format.substr(0, 60)));
}

/// Gives a grey file the encoding of the image before its compression, as `format` names it.
ImageView with_encoding_of(ImageView image, std::string_view format) {
  const auto named = find_encoding(encoding_in(format));
  const bool is_grey = image.encoding == "mono8" || image.encoding == "16UC1";
  const std::size_t bytes = image.encoding == "16UC1" ? 2 : 1;
  if (named && named->depth && (image.encoding != "16UC1" || named->sample != Sample::u16)) {
    throw ConfigurationError(
        with_code(Code::image_encoding,
                  "compressed images with the format '{}' contain {}, not {}; publish distances as "
                  "16UC1 in PNG, or as compressedDepth",
                  format.substr(0, 60), image.encoding, named->name));
  }
  const bool whole = named && (named->sample == Sample::u8 || named->sample == Sample::u16);
  if (is_grey && whole && !named->is_yuv() && named->pixel_bytes() == bytes) {
    image.encoding = named->name;
  }
  return image;
}

/// Converts quantised inverse depths to metres. 0 is not a reading.
ImageView to_metres(const ImageView& inverse, Bytes header, std::vector<std::byte>& pixels) {
  float parameters[2];
  std::memcpy(parameters, header.data() + 4, sizeof parameters);
  const auto [factor, offset] = parameters;
  if (!(std::isfinite(factor) && factor > 0 && std::isfinite(offset))) {
    throw TransportError(with_code(Code::damaged_message,
                                   "the depth parameters of its compressedDepth are {} and {}; the "
                                   "first must be above 0",
                                   factor, offset));
  }
  const std::size_t count = std::size_t{inverse.width} * inverse.height;
  std::vector<std::byte> metres(count * sizeof(float));
  for (std::size_t i = 0; i < count; ++i) {
    const auto first = static_cast<unsigned>(inverse.data[2 * i]);
    const auto second = static_cast<unsigned>(inverse.data[2 * i + 1]);
    const unsigned code = inverse.big_endian ? 256 * first + second : 256 * second + first;
    const float depth = code == 0 ? std::numeric_limits<float>::quiet_NaN()
                                  : factor / (static_cast<float>(code) - offset);
    std::memcpy(metres.data() + i * sizeof depth, &depth, sizeof depth);
  }
  pixels.swap(metres);
  return {inverse.width, inverse.height,       static_cast<std::uint32_t>(4 * inverse.width),
          "32FC1",       /*big_endian=*/false, pixels};
}

ImageView decode_depth(Bytes data, std::string_view format, std::vector<std::byte>& pixels) {
  const Bytes file = data.subspan(kDepthHeader);
  const bool is_rvl = contains(format, "compressedDepth rvl");
  if (!is_png(file) && !is_rvl) {
    if (contains(format, "compressedDepth ") && !contains(format, "compressedDepth png")) {
      fail_format(format, "");
    }
    fail_data(file, format);
  }
  const ImageView image = is_png(file) ? decode_png(file, pixels) : decode_rvl(file, pixels);
  if (image.encoding != "16UC1") {
    throw TransportError(with_code(
        Code::damaged_message, "its compressedDepth is a PNG of {}; it must have 16 bits of grey",
        image.encoding));
  }
  return encoding_in(format) == "32FC1" ? to_metres(image, data.first(kDepthHeader), pixels)
                                        : image;
}

}  // namespace

bool is_png(Bytes data) {
  return has_bytes(data, 0, "\x89PNG\r\n\x1a\n");
}

ImageView decode_compressed(Bytes data, std::string_view format, bool colour,
                            std::vector<std::byte>& pixels) {
  static_assert(std::endian::native == std::endian::little);
  const bool has_header =
      data.size() > kDepthHeader && !is_png(data) &&
      (contains(format, "compressedDepth") || is_png(data.subspan(kDepthHeader)));
  if (has_header) {
    return decode_depth(data, format, pixels);
  }
  if (is_png(data)) {
    return with_encoding_of(decode_png(data, pixels), format);
  }
  if (is_jpeg(data)) {
    const auto named = find_encoding(encoding_in(format));
    const bool bayer = named && named->layout == Layout::bayer;
    return with_encoding_of(decode_jpeg(data, colour || bayer, pixels), format);
  }
  fail_data(data, format);
}

}  // namespace spikeloop::images
