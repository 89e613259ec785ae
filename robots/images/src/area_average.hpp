// Averages of areas of a picture.
#pragma once

#include <cstdint>
#include <vector>

#include "encoding.hpp"
#include "spikeloop/images/image_settings.hpp"

namespace spikeloop::images {

/// Where the pixels of one axis of the result lie in the source: `first` counts by `first_weight`,
/// `last` by `last_weight`, those between by 1. When both are the same pixel, it counts by
/// `first_weight`.
struct Reach {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
  float first_weight = 1;
  float last_weight = 1;

  float weight(std::uint32_t pixel) const {
    return pixel == first ? first_weight : pixel == last ? last_weight : 1.0F;
  }
};

/// Pixel i of `count` covers [i size / count, (i + 1) size / count).
std::vector<Reach> reaches(std::uint32_t size, std::uint32_t count);

/// Keeps buffers and tables from one picture to the next.
class AreaAverage {
 public:
  /// Writes plane after plane of `size` into `values`: the averages of the crop, each of whose
  /// pixels counts by the part of it that is covered, in the encoding's unit. Depths are limited to
  /// [least, most] first, and those without a reading are left out; NaN where none is left.
  void average(const ImageView& image, const Encoding& encoding, const Crop& crop, Size size,
               Channel channel, double least, double most, std::vector<double>& values);

 private:
  void prepare(const Crop& crop, Size size);
  template <typename T>
  void average_rows(const ImageView& image, const Encoding& encoding, const Crop& crop,
                    const std::vector<std::vector<float>>& planes, double least, double most,
                    std::vector<double>& values);
  void put_row(std::uint32_t y, const Encoding& encoding, std::uint32_t width,
               const std::vector<std::vector<float>>& planes, std::vector<double>& values);

  Crop crop_{};
  Size size_{};
  std::vector<Reach> columns_;
  std::vector<Reach> rows_;
  std::vector<float> sum_;     ///< of rows, a value a sample
  std::vector<float> weight_;  ///< of depths: of the readings in it
  std::vector<float> light_;   ///< of one plane, a value a pixel
};

}  // namespace spikeloop::images
