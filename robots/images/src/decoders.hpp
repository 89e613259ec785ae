// Data of sensor_msgs/CompressedImage to rows of samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "spikeloop/images/image_view.hpp"

namespace spikeloop::images {

/// The decoders replace `pixels` and return a view of them.
/// @throws TransportError for a damaged file and for one with more than kMostPixels.
/// ConfigurationError for a format that cannot be read.

/// mono8 or rgb8. @param colour false: grey is enough
ImageView decode_jpeg(std::span<const std::byte> file, bool colour, std::vector<std::byte>& pixels);
/// mono8, rgb8, 16UC1 or rgb16.
ImageView decode_png(std::span<const std::byte> file, std::vector<std::byte>& pixels);
/// 16UC1, of the codec RVL (Wilson, "Fast lossless depth image compression", 2017) with the width
/// and the height before it, as compressed_depth_image_transport writes it.
ImageView decode_rvl(std::span<const std::byte> file, std::vector<std::byte>& pixels);
/// Any of these, with the encoding that `format` names. The view refers to `format`, too.
ImageView decode_compressed(std::span<const std::byte> data, std::string_view format, bool colour,
                            std::vector<std::byte>& pixels);

bool is_png(std::span<const std::byte> data);

}  // namespace spikeloop::images
