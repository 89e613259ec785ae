// Pixels of an image as numbers, for arrays of NumPy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/images/image_view.hpp"

namespace spikeloop::images {

struct Pixels {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::size_t components = 1;        ///< per pixel; of colours: red, green, blue, and alpha if any
  std::string type{};                ///< NumPy's type of a sample: "u1", "<f4"
  std::vector<std::byte> samples{};  ///< row by row, little-endian
};

/// Reads every encoding that ImageConversion reads, in the same way, and OpenCV's types with any
/// number of components. Samples keep their values: 0 and NaN may be pixels without a reading.
/// @throws TransportError if the image is damaged. ConfigurationError if it cannot be read.
Pixels read_pixels(const ImageView& image);
/// Reads the data of a CompressedImage in the same way. @param format the message's field `format`
Pixels read_compressed_pixels(std::span<const std::byte> data, std::string_view format);

}  // namespace spikeloop::images
