// From pictures to values in [-1, 1].
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "spikeloop/images/image_settings.hpp"
#include "spikeloop/images/image_view.hpp"

namespace spikeloop::images {

/// Pictures with more pixels are refused: a few bytes of PNG can claim to be gigabytes.
inline constexpr std::uint64_t kMostPixels = 1ULL << 25;

/// Crops, averages areas, scales and filters; docs/images.md has the formulas and the encodings.
/// Keeps its buffers, so that an image like the one before costs no allocation.
class ImageConversion {
 public:
  explicit ImageConversion(const ImageSettings& settings);
  ~ImageConversion();
  ImageConversion(ImageConversion&&) noexcept;
  ImageConversion& operator=(ImageConversion&&) noexcept;

  /// The values, plane by plane, valid until the next call. NaN: no pixel there has a reading (NaN
  /// of 32FC1 and 64FC1, 0 of 16UC1).
  /// @throws TransportError if the image is damaged or contradicts itself. ConfigurationError if
  /// the crop does not lie in it, the encoding needs a range, or it cannot be read.
  std::span<const double> convert(const ImageView& image);
  /// The same for the data of a CompressedImage: JPEG, PNG, or the compressedDepth of
  /// image_transport. @param format the message's field `format`
  std::span<const double> convert_compressed(std::span<const std::byte> data,
                                             std::string_view format = {});

  const ImageSettings& settings() const;
  /// Of the newest result.
  Size size() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::images
