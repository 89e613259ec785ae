#include "spikeloop/pictures/image.hpp"

#include <png.h>

#include <cerrno>

#include "spikeloop/core/error.hpp"

namespace spikeloop::pictures {

void write_png(const std::string& path, const Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = image.size.width;
  header.height = image.size.height;
  header.format = PNG_FORMAT_RGB;
  errno = 0;
  if (png_image_write_to_file(&header, path.c_str(), 0, image.rgb.data(), 0, nullptr) == 0) {
    throw FileError("write", path, errno != 0 ? errno : EIO);
  }
}

}  // namespace spikeloop::pictures
