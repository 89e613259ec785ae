// Pictures in memory and as files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace spikeloop::pictures {

/// In pixels.
struct Size {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  friend bool operator==(const Size&, const Size&) = default;
};

/// Rows from top to bottom, pixels from left to right, a byte each of red, green and blue.
struct Image {
  Size size;
  std::vector<std::uint8_t> rgb;
};

/// @throws FileError.
void write_png(const std::string& path, const Image& image);

}  // namespace spikeloop::pictures
