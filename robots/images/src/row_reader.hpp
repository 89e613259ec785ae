// Rows of an image as samples, independent of its encoding.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "encoding.hpp"

namespace spikeloop::images {

/// Reads an image that check_image() has accepted.
/// @tparam T the type of Encoding::sample
template <typename T>
class RowReader {
 public:
  /// @param encoding with one component, a YUV image is read as its luma
  RowReader(const ImageView& image, const Encoding& encoding)
      : image_(image), encoding_(encoding) {}

  /// The components of row y, pixel by pixel. Valid until the next call.
  std::span<const T> row(std::uint32_t y) {
    const std::byte* const at = image_.data.data() + std::size_t{y} * image_.step;
    const std::size_t samples = std::size_t{image_.width} * encoding_.components;
    if (sizeof(T) == 1 && encoding_.layout == Layout::plain) {
      return {reinterpret_cast<const T*>(at), samples};
    }
    buffer_.resize(samples);
    if (encoding_.layout == Layout::plain) {
      std::memcpy(buffer_.data(), at, samples * sizeof(T));
      if (sizeof(T) > 1 && image_.big_endian) {
        std::ranges::for_each(buffer_, swap_bytes);
      }
    } else if constexpr (std::is_unsigned_v<T>) {
      if (encoding_.layout == Layout::bayer) {
        fill_from_cells(y);
      } else {
        fill_from_yuv(y);
      }
    }
    return buffer_;
  }

 private:
  static void swap_bytes(T& sample) {
    auto* const bytes = reinterpret_cast<unsigned char*>(&sample);
    std::reverse(bytes, bytes + sizeof(T));
  }

  T sample_at(const std::byte* at) const {
    T sample;
    std::memcpy(&sample, at, sizeof(T));
    if (sizeof(T) > 1 && image_.big_endian) {
      swap_bytes(sample);
    }
    return sample;
  }

  static T limited(float value) { return static_cast<T>(std::clamp(value + 0.5F, 0.0F, 255.0F)); }

  /// A row of luma and chroma. Pixel x has the luma luma[x * luma_step], and U and V at
  /// chroma[x / shared * chroma_step + u], and v.
  struct Yuv {
    const std::uint8_t* luma;
    const std::uint8_t* chroma;
    std::size_t luma_step;
    std::size_t chroma_step;
    std::size_t shared;
    std::size_t u;
    std::size_t v;
  };

  Yuv yuv_row(std::uint32_t y) const {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(image_.data.data());
    const std::uint8_t* const row = bytes + std::size_t{y} * image_.step;
    if (encoding_.layout == Layout::uyvy) {
      return {row + 1, row, 2, 4, 2, 0, 2};
    }
    if (encoding_.layout == Layout::yuyv) {
      return {row, row + 1, 2, 4, 2, 0, 2};
    }
    const Planes planes = planes_of(image_, encoding_.layout);
    const std::size_t shared = encoding_.layout == Layout::nv24 ? 1 : 2;
    const std::size_t u = encoding_.layout == Layout::nv21 ? 1 : 0;
    const std::uint8_t* const chroma = bytes + planes.chroma + y / shared * planes.chroma_stride;
    return {bytes + y * planes.luma_stride, chroma, 1, 2, shared, u, 1 - u};
  }

  /// BT.601 with samples from 0 to 255, as in JPEG.
  void fill_from_yuv(std::uint32_t y) {
    const Yuv yuv = yuv_row(y);
    for (std::size_t x = 0; x < image_.width; ++x) {
      const std::uint8_t luma = yuv.luma[x * yuv.luma_step];
      if (encoding_.components == 1) {
        buffer_[x] = luma;
        continue;
      }
      const std::uint8_t* const pair = yuv.chroma + x / yuv.shared * yuv.chroma_step;
      const float u = static_cast<float>(pair[yuv.u]) - 128.0F;
      const float v = static_cast<float>(pair[yuv.v]) - 128.0F;
      buffer_[3 * x] = limited(luma + 1.402F * v);
      buffer_[3 * x + 1] = limited(luma - 0.344136F * u - 0.714136F * v);
      buffer_[3 * x + 2] = limited(luma + 1.772F * u);
    }
  }

  /// All four pixels of a cell have its red, the mean of its two greens, its blue. An odd last row
  /// or column belongs to the cell before it, from which it takes the colours.
  void fill_from_cells(std::uint32_t y) {
    const std::uint32_t top = std::min(y / 2 * 2, (image_.height - 2) / 2 * 2);
    const std::byte* const rows = image_.data.data() + std::size_t{top} * image_.step;
    const std::uint32_t last = (image_.width - 2) / 2 * 2;
    const auto first = [&](std::size_t place) {
      return rows + place / 2 * image_.step + place % 2 * sizeof(T);
    };
    const std::byte* const red = first(encoding_.rgb[0]);
    const std::byte* const green = first(encoding_.rgb[1]);
    const std::byte* const other = first(3U - encoding_.rgb[1]);  // green lies across the cell, too
    const std::byte* const blue = first(encoding_.rgb[2]);
    T* to = buffer_.data();
    for (std::uint32_t x = 0, width = image_.width; x < width; ++x, to += 3) {
      const std::size_t cell = std::min(x / 2 * 2, last) * sizeof(T);
      const unsigned greens = sample_at(green + cell) + sample_at(other + cell);
      to[0] = sample_at(red + cell);
      to[1] = static_cast<T>((greens + 1) / 2);
      to[2] = sample_at(blue + cell);
    }
  }

  ImageView image_;
  const Encoding& encoding_;
  std::vector<T> buffer_;
};

}  // namespace spikeloop::images
