// Where the pixels of an image message lie.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "spikeloop/images/image_view.hpp"
#include "spikeloop/messages/dialect.hpp"

namespace spikeloop::messages {

inline constexpr std::string_view kImage = "sensor_msgs/Image";
inline constexpr std::string_view kCompressedImage = "sensor_msgs/CompressedImage";

struct CompressedImage {
  std::string_view format;
  std::span<const std::byte> data;
};

/// Views of the message's bytes: nothing is copied. @throws TransportError when they end too early.
images::ImageView read_image(Dialect dialect, std::span<const std::byte> message);
CompressedImage read_compressed_image(Dialect dialect, std::span<const std::byte> message);

}  // namespace spikeloop::messages
