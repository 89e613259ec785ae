// Worlds whose pictures are known, and a look at pixels.
#pragma once

#include <png.h>

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "spikeloop/pictures/image.hpp"
#include "spikeloop/vehicle/vehicle.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::pictures {

inline constexpr TimeNs kMs = 1'000'000;

/// The shipped vehicle at the origin, heading along x, among these bodies. Everything is as bright
/// as its colour, from everywhere.
class World {
 public:
  explicit World(const std::string& bodies, const std::string& start = "0 0 0")
      : path_(directory_.write(
            "world.xml",
            "<mujoco><size njmax=\"200\" nconmax=\"50\"/><include "
            "file=\"spikeloop_vehicle.xml\"/><visual><headlight ambient=\"1 1 1\" "
            "diffuse=\"0 0 0\" specular=\"0 0 0\"/><map znear=\"0.002\"/><quality "
            "shadowsize=\"256\"/></visual><custom><numeric "
            "name=\"arena\" data=\"-3 -3 3 3\"/><numeric name=\"start\" data=\"" +
                start +
                "\"/></custom><worldbody><geom name=\"floor\" type=\"plane\" size=\"9 9 0.1\" "
                "rgba=\"0.5 0.5 0.5 1\"/>" +
                bodies + "</worldbody></mujoco>")) {}

  vehicle::Vehicle vehicle() const { return vehicle::Vehicle({path_, 1}); }
  const std::string& path() const { return path_; }

 private:
  test::TemporaryDirectory directory_;
  std::string path_;
};

using Colour = std::array<int, 3>;

inline Colour at(const Image& image, std::uint32_t column, std::uint32_t row) {
  const std::size_t first = 3 * (static_cast<std::size_t>(row) * image.size.width + column);
  return {image.rgb.at(first), image.rgb.at(first + 1), image.rgb.at(first + 2)};
}

/// Columns of a row, or all, in which a channel is brighter than the others by far.
inline std::vector<std::uint32_t> columns_of(const Image& image, std::size_t channel,
                                             std::uint32_t row) {
  std::vector<std::uint32_t> columns;
  for (std::uint32_t column = 0; column < image.size.width; ++column) {
    const Colour pixel = at(image, column, row);
    if (pixel[channel] > 60 + pixel[(channel + 1) % 3] &&
        pixel[channel] > 60 + pixel[(channel + 2) % 3]) {
      columns.push_back(column);
    }
  }
  return columns;
}

/// By libpng itself.
inline Image read_png(const std::string& path) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&header, path.c_str()) == 0) {
    throw std::runtime_error(path + ": " + header.message);
  }
  header.format = PNG_FORMAT_RGB;
  Image image{{header.width, header.height}, std::vector<std::uint8_t>(PNG_IMAGE_SIZE(header))};
  png_image_finish_read(&header, nullptr, image.rgb.data(), 0, nullptr);
  return image;
}

}  // namespace spikeloop::pictures
