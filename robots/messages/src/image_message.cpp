#include "image_message.hpp"

#include "header.hpp"

namespace spikeloop::messages {

images::ImageView read_image(Dialect dialect, std::span<const std::byte> message) {
  return with_reader(dialect, message, [&](auto& reader) {
    skip_header(reader, dialect);
    images::ImageView image;
    image.height = read_uint32(reader);
    image.width = read_uint32(reader);
    image.encoding = reader.text();
    image.big_endian = reader.number(Primitive::uint8) != 0;
    image.step = read_uint32(reader);
    image.data = read_bytes(reader);
    return image;
  });
}

CompressedImage read_compressed_image(Dialect dialect, std::span<const std::byte> message) {
  return with_reader(dialect, message, [&](auto& reader) {
    skip_header(reader, dialect);
    CompressedImage image;
    image.format = reader.text();
    image.data = read_bytes(reader);
    return image;
  });
}

}  // namespace spikeloop::messages
