// What is made of a picture, and the keys that say so.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "spikeloop/core/parameters.hpp"

namespace spikeloop::images {

/// A part of a picture, in pixels from its upper left corner.
struct Crop {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

struct Size {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

enum class Channel : std::uint8_t { grey, red, green, blue, rgb };
enum class Intensity : std::uint8_t { linear, log };
enum class Filter : std::uint8_t { none, centre_surround, on_off };

/// docs/images.md has the formulas.
struct ImageSettings {
  std::optional<Crop> crop{};    ///< none: the whole picture
  std::optional<Size> resize{};  ///< after the crop; none: as it is
  Channel channel = Channel::grey;
  /// What becomes -1 and 1, in the encoding's unit; none: all that whole-number samples can be.
  std::optional<std::pair<double, double>> range{};
  Intensity intensity = Intensity::linear;
  Filter filter = Filter::none;
  double centre = 1;    ///< standard deviation of the filter's centre, pixels of the result
  double surround = 3;  ///< of its surround
  double gain = 1;      ///< of the filter

  /// Planes one after the other, each `height` rows of `width` values.
  std::uint32_t planes() const {
    return (channel == Channel::rgb ? 3U : 1U) * (filter == Filter::on_off ? 2U : 1U);
  }
  /// Number of values; nothing when it is the picture's to say.
  std::optional<std::uint32_t> values() const;
};

/// The longest side of a result, in pixels.
inline constexpr std::uint32_t kLongestSide = 4096;

/// The keys: crop, resize, channel, range, intensity, filter, centre, surround, gain.
std::vector<ParameterDescription> image_parameters();

/// @throws ConfigurationError with the key, its value and what to write.
ImageSettings image_settings(const Parameters& parameters);

}  // namespace spikeloop::images
