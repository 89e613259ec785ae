// JPEG and PNG files to rows of samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "spikeloop/images/image_view.hpp"

namespace spikeloop::images {

/// Replaces `pixels`; what is returned is a view of them: mono8, rgb8 or, of a PNG of 16 bits,
/// mono16. @param colour false: grey is enough
/// @throws TransportError for a damaged file and for one with more than kMostPixels.
ImageView decode_jpeg(std::span<const std::byte> file, bool colour, std::vector<std::byte>& pixels);
ImageView decode_png(std::span<const std::byte> file, std::vector<std::byte>& pixels);

}  // namespace spikeloop::images
