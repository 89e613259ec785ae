// Pictures as JPEG files, made by libjpeg.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>  // jpeglib.h needs it
#include <cstdlib>
#include <vector>

#include <jpeglib.h>

namespace spikeloop::test {

struct JpegKind {
  J_COLOR_SPACE in = JCS_RGB;
  J_COLOR_SPACE file = JCS_YCbCr;
  int quality = 80;            ///< 1 to 100
  bool halved_colours = true;  ///< one sample of colour for 2 x 2 pixels, as cameras do
  bool progressive = false;
};

/// @param samples rows of `width` pixels, each of as many bytes as `kind.in` has components
inline std::vector<std::byte> jpeg_file(std::vector<std::uint8_t> samples, unsigned width,
                                        unsigned height, const JpegKind& kind) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&info, &buffer, &size);
  info.image_width = width;
  info.image_height = height;
  info.input_components = static_cast<int>(samples.size() / (width * height));
  info.in_color_space = kind.in;
  jpeg_set_defaults(&info);
  jpeg_set_colorspace(&info, kind.file);
  jpeg_set_quality(&info, kind.quality, TRUE);
  for (int i = 0; i < info.num_components && !kind.halved_colours; ++i) {
    info.comp_info[i].h_samp_factor = info.comp_info[i].v_samp_factor = 1;
  }
  if (kind.progressive) {
    jpeg_simple_progression(&info);
  }
  jpeg_start_compress(&info, TRUE);
  const std::size_t row_bytes = samples.size() / height;
  while (info.next_scanline < height) {
    JSAMPROW row = samples.data() + info.next_scanline * row_bytes;
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  const auto* first = reinterpret_cast<const std::byte*>(buffer);
  std::vector<std::byte> file(first, first + size);
  std::free(buffer);
  return file;
}

}  // namespace spikeloop::test
