#include <fmt/format.h>
#include <png.h>

#include <csetjmp>
#include <cstdio>
#include <cstring>

#include "decoders.hpp"
#include "encoding.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::images {
namespace {

/// As with libjpeg: errors come back by longjmp, and whatever has a destructor is here.
struct PngDecoder {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::span<const std::byte> left;
  std::vector<png_bytep> rows;
  char reason[200] = "no memory";

  explicit PngDecoder(std::span<const std::byte> file) : left(file) {
    png = png_create_read_struct(
        PNG_LIBPNG_VER_STRING, this,
        [](png_structp from, png_const_charp text) {
          auto& self = *static_cast<PngDecoder*>(png_get_error_ptr(from));
          std::snprintf(self.reason, sizeof self.reason, "%s", text);
          png_longjmp(from, 1);
        },
        [](png_structp, png_const_charp) {});
    info = png != nullptr ? png_create_info_struct(png) : nullptr;
  }
  ~PngDecoder() { png_destroy_read_struct(&png, &info, nullptr); }
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;

  static void read(png_structp from, png_bytep to, std::size_t count) {
    auto& self = *static_cast<PngDecoder*>(png_get_io_ptr(from));
    if (count > self.left.size()) {
      png_error(from, "it ends too early");
    }
    std::memcpy(to, self.left.data(), count);
    self.left = self.left.subspan(count);
  }

  /// Every PNG becomes grey or RGB of 8 or 16 bits.
  bool read_header() {
    if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
      return false;
    }
    png_set_read_fn(png, this, read);
    png_set_user_limits(png, 1U << 25, 1U << 25);
    png_set_chunk_cache_max(png, 100);
    png_set_chunk_malloc_max(png, 1U << 20);
    png_read_info(png, info);
    png_set_expand(png);
    png_set_strip_alpha(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    return true;
  }

  bool read_rows() {
    if (setjmp(png_jmpbuf(png)) != 0) {
      return false;
    }
    png_read_image(png, rows.data());
    png_read_end(png, nullptr);
    return true;
  }

  [[noreturn]] void fail() const {
    throw TransportError(with_code(Code::damaged_message, "its PNG is damaged: {}", reason));
  }
};

}  // namespace

ImageView decode_png(std::span<const std::byte> file, std::vector<std::byte>& pixels) {
  PngDecoder decoder(file);
  if (!decoder.read_header()) {
    decoder.fail();
  }
  const std::uint32_t width = png_get_image_width(decoder.png, decoder.info);
  const std::uint32_t height = png_get_image_height(decoder.png, decoder.info);
  check_area("its PNG", width, height);
  const std::size_t step = png_get_rowbytes(decoder.png, decoder.info);
  pixels.resize(step * height);
  for (std::uint32_t y = 0; y < height; ++y) {
    decoder.rows.push_back(reinterpret_cast<png_bytep>(pixels.data() + y * step));
  }
  if (!decoder.read_rows()) {
    decoder.fail();
  }
  const bool colour = png_get_channels(decoder.png, decoder.info) == 3;
  const bool wide = png_get_bit_depth(decoder.png, decoder.info) == 16;
  const char* const encoding = wide ? (colour ? "rgb16" : "16UC1") : (colour ? "rgb8" : "mono8");
  return {width, height, static_cast<std::uint32_t>(step), encoding, true, pixels};
}

}  // namespace spikeloop::images
