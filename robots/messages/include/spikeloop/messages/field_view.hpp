// Bytes and texts of a message where they stand, without a copy: for the payload of images and
// point clouds, which FieldReader would turn into doubles one by one.
//
//     const BytesField data(catalog, "sensor_msgs/Image", "data");
//     const TextField encoding(catalog, "sensor_msgs/Image", "encoding");
//     const FieldReader step(catalog, "sensor_msgs/Image", "step");
//
// What they return is valid as long as the message's bytes. Both dialects; nothing about the bytes
// is taken for granted.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "spikeloop/messages/field_path.hpp"

namespace spikeloop::messages {

/// The elements of an array of bytes: Image.data, CompressedImage.data, PointCloud2.data,
/// EventPacket.events, or a slice of them.
class BytesField {
 public:
  /// @throws ConfigurationError as compile_path, and when the path ends at anything but an array
  /// of uint8, int8, byte, char or bool, or may name elements of several arrays.
  BytesField(const Catalog& catalog, std::string_view type, std::string_view path);

  /// Empty when the array has no such elements. @throws TransportError as FieldReader::read.
  std::span<const std::byte> read(std::span<const std::byte> message) const;

  const FieldPath& path() const { return path_; }

 private:
  FieldPath path_;
};

/// The texts of one path: Image.encoding, header.frame_id, PointCloud2's fields.name (one each).
class TextField {
 public:
  /// @throws ConfigurationError as compile_path, and when the path ends at a number.
  TextField(const Catalog& catalog, std::string_view type, std::string_view path);

  /// Appends the path's texts; returns how many came. @throws TransportError as FieldReader::read.
  std::size_t read(std::span<const std::byte> message, std::vector<std::string_view>& texts) const;

  const FieldPath& path() const { return path_; }

 private:
  FieldPath path_;
};

}  // namespace spikeloop::messages
