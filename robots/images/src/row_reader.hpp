// The rows of a picture as samples, whatever its encoding.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "encoding.hpp"

namespace spikeloop::images {

/// Of a picture that check_image() has let through. Sample: uint8_t, uint16_t or float, as its
/// encoding says.
template <typename T>
class RowReader {
 public:
  RowReader(const ImageView& image, const Encoding& encoding)
      : image_(image), encoding_(encoding) {}

  /// Row y with its components in turn. Valid until the next call.
  std::span<const T> row(std::uint32_t y) {
    const std::byte* const at = image_.data.data() + std::size_t{y} * image_.step;
    const std::size_t samples = std::size_t{image_.width} * encoding_.components;
    if constexpr (sizeof(T) == 1) {
      if (encoding_.layout == Layout::plain) {
        return {reinterpret_cast<const T*>(at), samples};
      }
      buffer_.resize(samples);
      if (encoding_.layout == Layout::bayer) {
        fill_from_cells(y);
      } else {
        fill_from_pairs(at);
      }
    } else {
      buffer_.resize(samples);
      std::memcpy(buffer_.data(), at, samples * sizeof(T));
      if (image_.big_endian) {
        std::ranges::for_each(buffer_, swap_bytes);
      }
    }
    return buffer_;
  }

 private:
  static void swap_bytes(T& sample) {
    auto* const bytes = reinterpret_cast<unsigned char*>(&sample);
    std::reverse(bytes, bytes + sizeof(T));
  }

  static T limited(float value) { return static_cast<T>(std::clamp(value + 0.5F, 0.0F, 255.0F)); }

  /// BT.601 with samples from 0 to 255, as JPEG has it.
  void fill_from_pairs(const std::byte* at) {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(at);
    const bool luma_first = encoding_.layout == Layout::yuyv;
    for (std::size_t x = 0; x < image_.width; ++x) {
      const std::uint8_t* const pair = bytes + x / 2 * 4;
      const float luma = pair[(luma_first ? 0 : 1) + x % 2 * 2];
      const float u = static_cast<float>(pair[luma_first ? 1 : 0]) - 128.0F;
      const float v = static_cast<float>(pair[luma_first ? 3 : 2]) - 128.0F;
      buffer_[3 * x] = limited(luma + 1.402F * v);
      buffer_[3 * x + 1] = limited(luma - 0.344136F * u - 0.714136F * v);
      buffer_[3 * x + 2] = limited(luma + 1.772F * u);
    }
  }

  /// All four pixels of a cell have its red, the mean of its two greens, its blue. An odd last row
  /// or column belongs to the cell before it, from which it takes the colours.
  void fill_from_cells(std::uint32_t y) {
    const std::uint32_t top = std::min(y / 2 * 2, (image_.height - 2) / 2 * 2);
    const auto* const rows =
        reinterpret_cast<const std::uint8_t*>(image_.data.data()) + std::size_t{top} * image_.step;
    const std::uint32_t last = (image_.width - 2) / 2 * 2;
    const auto [red, green, blue] = encoding_.rgb;
    // The other green pixel lies across the cell.
    const std::size_t other = 3U - green;
    for (std::uint32_t x = 0; x < image_.width; ++x) {
      const std::uint8_t* const cell = rows + std::min(x / 2 * 2, last);
      const auto pixel = [&](std::size_t place) -> unsigned {
        return cell[place / 2 * image_.step + place % 2];
      };
      buffer_[std::size_t{3} * x] = static_cast<T>(pixel(red));
      buffer_[std::size_t{3} * x + 1] = static_cast<T>((pixel(green) + pixel(other) + 1) / 2);
      buffer_[std::size_t{3} * x + 2] = static_cast<T>(pixel(blue));
    }
  }

  ImageView image_;
  const Encoding& encoding_;
  std::vector<T> buffer_;
};

}  // namespace spikeloop::images
