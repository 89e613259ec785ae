#include <cstdio>  // jpeglib.h needs it

#include <jpeglib.h>

#include <jerror.h>

#include <csetjmp>
#include <string>

#include <fmt/format.h>

#include "decoders.hpp"
#include "encoding.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::images {
namespace {

/// Decoding a scan of a progressive file costs as much as a picture.
constexpr int kMostScans = 100;

/// libjpeg's errors come back by longjmp: nothing with a destructor may live between the jump and
/// setjmp(), so all of it is here.
struct JpegDecoder {
  jpeg_decompress_struct info{};
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  std::jmp_buf jump{};
  char reason[JMSG_LENGTH_MAX] = "";
  bool damaged = false;

  JpegDecoder() {
    info.err = jpeg_std_error(&errors);
    info.client_data = this;
    errors.error_exit = [](j_common_ptr common) {
      auto& self = *static_cast<JpegDecoder*>(common->client_data);
      common->err->format_message(common, self.reason);
      std::longjmp(self.jump, 1);
    };
    // Bytes that nobody needs do no harm; every other warning means that pixels are guessed.
    errors.emit_message = [](j_common_ptr common, int level) {
      auto& self = *static_cast<JpegDecoder*>(common->client_data);
      if (level < 0 && common->err->msg_code != JWRN_EXTRANEOUS_DATA && !self.damaged) {
        common->err->format_message(common, self.reason);
        self.damaged = true;
      }
    };
    errors.output_message = [](j_common_ptr) {};
    progress.progress_monitor = [](j_common_ptr common) {
      auto& self = *static_cast<JpegDecoder*>(common->client_data);
      if (self.info.input_scan_number > kMostScans) {
        std::snprintf(self.reason, sizeof self.reason, "it has more than %d scans", kMostScans);
        std::longjmp(self.jump, 1);
      }
    };
  }
  ~JpegDecoder() { jpeg_destroy_decompress(&info); }
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;

  bool read_header(std::span<const std::byte> file) {
    if (setjmp(jump) != 0) {
      return false;
    }
    jpeg_create_decompress(&info);
    info.progress = &progress;
    jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(file.data()),
                 static_cast<unsigned long>(file.size()));
    jpeg_read_header(&info, TRUE);
    return true;
  }

  bool read_rows(std::span<std::byte> pixels, std::size_t step) {
    if (setjmp(jump) != 0) {
      return false;
    }
    jpeg_start_decompress(&info);
    while (info.output_scanline < info.output_height && !damaged) {
      auto* row = reinterpret_cast<JSAMPROW>(pixels.data() + info.output_scanline * step);
      jpeg_read_scanlines(&info, &row, 1);
    }
    if (!damaged) {
      jpeg_finish_decompress(&info);
    }
    return !damaged;
  }

  [[noreturn]] void fail() const {
    throw TransportError(with_code(Code::damaged_message, "its JPEG is damaged: {}", reason));
  }
};

}  // namespace

ImageView decode_jpeg(std::span<const std::byte> file, bool colour,
                      std::vector<std::byte>& pixels) {
  JpegDecoder decoder;
  if (!decoder.read_header(file)) {
    decoder.fail();
  }
  jpeg_decompress_struct& info = decoder.info;
  check_area("its JPEG", info.image_width, info.image_height);
  const bool grey = info.jpeg_color_space == JCS_GRAYSCALE;
  if (!grey && info.jpeg_color_space != JCS_YCbCr && info.jpeg_color_space != JCS_RGB) {
    const bool cmyk = info.jpeg_color_space == JCS_CMYK || info.jpeg_color_space == JCS_YCCK;
    throw ConfigurationError(
        with_code(Code::image_encoding,
                  "JPEG files with {} colours cannot be read; publish JPEG with grey, YCbCr or RGB",
                  cmyk ? "CMYK" : "unknown"));
  }
  // The grey of YCbCr is its Y. libjpeg makes no grey of RGB.
  const bool to_grey = grey || (!colour && info.jpeg_color_space == JCS_YCbCr);
  info.out_color_space = to_grey ? JCS_GRAYSCALE : JCS_RGB;
  const std::size_t step = info.image_width * (to_grey ? 1U : 3U);
  pixels.resize(step * info.image_height);
  if (!decoder.read_rows(pixels, step)) {
    decoder.fail();
  }
  return {info.image_width,
          info.image_height,
          static_cast<std::uint32_t>(step),
          to_grey ? "mono8" : "rgb8",
          false,
          pixels};
}

}  // namespace spikeloop::images
