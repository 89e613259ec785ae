// A picture where it lies: rows of pixels, as sensor_msgs/Image has them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace spikeloop::images {

/// Nothing about it is taken for granted.
struct ImageView {
  std::uint32_t width = 0;   ///< pixels
  std::uint32_t height = 0;  ///< pixels
  std::uint32_t step = 0;    ///< bytes from one row to the next
  std::string_view encoding{};
  bool big_endian = false;  ///< of samples longer than a byte
  std::span<const std::byte> data{};
};

}  // namespace spikeloop::images
