// Encodings of sensor_msgs/Image.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "spikeloop/images/image_view.hpp"

namespace spikeloop::images {

/// Arrangement of the samples. uyvy and yuyv: two pixels share their chroma. nv12, nv21 and nv24: a
/// plane of luma, followed by one of chroma (V4L2's formats of these names).
enum class Layout : std::uint8_t { plain, bayer, uyvy, yuyv, nv12, nv21, nv24 };
enum class Sample : std::uint8_t { u8, s8, u16, s16, s32, f32, f64 };

/// Calls `work` with a value of the type of these samples.
template <typename Work>
void with_sample(Sample sample, Work&& work) {
  switch (sample) {
    case Sample::u8:
      return work(std::uint8_t{});
    case Sample::s8:
      return work(std::int8_t{});
    case Sample::u16:
      return work(std::uint16_t{});
    case Sample::s16:
      return work(std::int16_t{});
    case Sample::s32:
      return work(std::int32_t{});
    case Sample::f32:
      return work(float{});
    case Sample::f64:
      return work(double{});
  }
}

struct Encoding {
  std::string_view name;
  Layout layout = Layout::plain;
  Sample sample = Sample::u8;
  std::uint8_t components = 1;  ///< samples per pixel of a row that RowReader has read
  /// Indices of red, green and blue among the components; of a Bayer encoding, their positions in
  /// the cell of 2 x 2 pixels (0 to 3, row by row; of green, one of two).
  std::array<std::uint8_t, 3> rgb{0, 0, 0};
  /// Measured values, such as distances: each is limited to the range, and some pixels have no
  /// reading.
  bool depth = false;

  bool is_yuv() const { return layout != Layout::plain && layout != Layout::bayer; }
  std::size_t sample_bytes() const;
  /// Bytes per pixel in a row; of nv12, nv21 and nv24, in a row of luma.
  std::size_t pixel_bytes() const;
  /// Value of white; 0 if the encoding does not define it.
  double greatest() const;
};

/// nullopt if the encoding is unknown. `name` must outlive the result.
/// @param any_components accepts OpenCV's types without defined colours, such as 32FC2
std::optional<Encoding> find_encoding(std::string_view name, bool any_components = false);

/// Position of the planes of nv12, nv21 and nv24, in bytes.
struct Planes {
  std::uint64_t luma_stride = 0;
  std::uint64_t chroma = 0;  ///< its first byte
  std::uint64_t chroma_stride = 0;
  std::uint64_t end = 0;  ///< behind the last byte that is used
};
Planes planes_of(const ImageView& image, Layout layout);

/// @param what name of the data in error messages
/// @throws TransportError: no pixels, or more than kMostPixels
void check_area(std::string_view what, std::uint64_t width, std::uint64_t height);
/// Compares the image with its encoding and the number of its bytes.
/// @param any_components as in find_encoding()
/// @throws ConfigurationError for an unknown encoding, TransportError for a contradiction.
Encoding check_image(const ImageView& image, bool any_components = false);

}  // namespace spikeloop::images
