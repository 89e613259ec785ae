// What the names of sensor_msgs/Image's encodings mean.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "spikeloop/images/image_view.hpp"

namespace spikeloop::images {

/// How pixels lie in a row.
enum class Layout : std::uint8_t { plain, uyvy, yuyv, bayer };
enum class Sample : std::uint8_t { u8, u16, f32 };

struct Encoding {
  std::string_view name;
  Layout layout = Layout::plain;
  Sample sample = Sample::u8;
  std::uint8_t components = 1;  ///< samples a pixel of a plain row
  /// Places of red, green and blue among the components; of a Bayer cell's colours, see Rows.
  std::array<std::uint8_t, 3> rgb{0, 0, 0};
  bool depth = false;  ///< distances: some pixels have no reading

  std::size_t pixel_bytes() const;
  bool has_colours() const { return components > 1 || layout != Layout::plain; }
  /// Of whole-number samples; 0: none.
  double greatest() const;
};

/// @throws TransportError that names those that are known.
const Encoding& encoding_named(std::string_view name);

/// Holds the picture against its encoding and its bytes.
/// @throws TransportError that says what does not fit.
const Encoding& check_image(const ImageView& image);

}  // namespace spikeloop::images
