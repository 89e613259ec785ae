#include "spikeloop/pictures/image.hpp"

#include <png.h>

#include <cerrno>
#include <cstdio>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"

namespace spikeloop::pictures {

void write_png(const std::string& path, const Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = image.size.width;
  header.height = image.size.height;
  header.format = PNG_FORMAT_RGB;
  std::FILE* const file = ::fdopen(create_file(path), "wb");
  errno = 0;
  const int written = png_image_write_to_stdio(&header, file, 0, image.rgb.data(), 0, nullptr);
  if (std::fclose(file) != 0 || written == 0) {
    throw FileError("write", path, errno != 0 ? errno : EIO);
  }
}

}  // namespace spikeloop::pictures
