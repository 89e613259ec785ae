// From pictures to values in [-1, 1].
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "spikeloop/images/image_settings.hpp"
#include "spikeloop/images/image_view.hpp"

namespace spikeloop::images {

/// Pictures with more pixels are refused: a few bytes of PNG can claim to be gigabytes.
inline constexpr std::uint64_t kMostPixels = 1ULL << 25;

/// Takes the part, averages areas of it, scales, filters; docs/images.md has the formulas. Keeps
/// its buffers, so that a picture like the one before costs no allocation.
///
/// Raw encodings: mono8, 8UC1, mono16, 16UC1, 32FC1, rgb8, bgr8, rgba8, bgra8, yuv422 (uyvy),
/// yuv422_yuy2 (yuyv), bayer_rggb8, bayer_bggr8, bayer_gbrg8, bayer_grbg8. Compressed: JPEG of grey
/// and YCbCr, PNG of all kinds, known by their first bytes.
class ImageConversion {
 public:
  explicit ImageConversion(const ImageSettings& settings);
  ~ImageConversion();
  ImageConversion(ImageConversion&&) noexcept;
  ImageConversion& operator=(ImageConversion&&) noexcept;

  /// The values, plane by plane, valid until the next call. NaN: all pixels there are without a
  /// reading (NaN of 32FC1, 0 of 16UC1).
  /// @throws TransportError: the picture is damaged, contradicts itself, or is of a kind that is
  /// not known. ConfigurationError: the crop does not lie in it; the encoding needs a range.
  std::span<const double> convert(const ImageView& image);
  /// The same for the bytes of a JPEG or PNG file.
  std::span<const double> convert_compressed(std::span<const std::byte> file);

  const ImageSettings& settings() const;
  /// Of the newest result.
  Size size() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::images
