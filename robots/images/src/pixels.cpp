#include "spikeloop/images/pixels.hpp"

#include <fmt/format.h>

#include <cstring>
#include <type_traits>

#include "decoders.hpp"
#include "row_reader.hpp"

namespace spikeloop::images {
namespace {

template <typename T>
void append_rows(const ImageView& image, const Encoding& encoding, Pixels& pixels) {
  RowReader<T> reader(image, encoding);
  const std::size_t row_bytes = image.width * pixels.components * sizeof(T);
  pixels.samples.resize(row_bytes * image.height);
  const bool swap = encoding.layout == Layout::plain && encoding.rgb[0] > encoding.rgb[2];
  for (std::uint32_t y = 0; y < image.height; ++y) {
    std::byte* const row = pixels.samples.data() + y * row_bytes;
    std::memcpy(row, reader.row(y).data(), row_bytes);
    for (std::size_t x = 0; swap && x < image.width; ++x) {
      std::byte* const pixel = row + x * pixels.components * sizeof(T);
      std::swap_ranges(pixel, pixel + sizeof(T), pixel + 2 * sizeof(T));
    }
  }
}

}  // namespace

Pixels read_pixels(const ImageView& image) {
  const Encoding encoding = check_image(image, /*any_components=*/true);
  Pixels pixels{image.width, image.height, encoding.components, {}, {}};
  with_sample(encoding.sample, [&]<typename T>(T /*sample*/) {
    const char kind = std::is_floating_point_v<T> ? 'f' : std::is_signed_v<T> ? 'i' : 'u';
    pixels.type = fmt::format("<{}{}", kind, sizeof(T));
    append_rows<T>(image, encoding, pixels);
  });
  return pixels;
}

Pixels read_compressed_pixels(std::span<const std::byte> data, std::string_view format) {
  std::vector<std::byte> decoded;
  return read_pixels(decode_compressed(data, format, /*colour=*/true, decoded));
}

}  // namespace spikeloop::images
