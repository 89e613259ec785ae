#include "spikeloop/messages/field_view.hpp"

#include <fmt/format.h>

#include "path_walk.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::messages {

BytesField::BytesField(const Catalog& catalog, std::string_view type, std::string_view path)
    : path_(compile_path(catalog, type, path)) {
  const FieldLayout& target = path_.target();
  const bool of_bytes = target.primitive == Primitive::uint8 ||
                        target.primitive == Primitive::int8 ||
                        target.primitive == Primitive::boolean;
  if (!of_bytes || target.array == ArrayKind::none) {
    throw ConfigurationError(
        with_code(Code::field_path,
                  "field path '{}' of {}: it names no array of bytes; name one, as in data of "
                  "sensor_msgs/Image",
                  path_.text, path_.type->name));
  }
  for (std::size_t i = 0; i + 1 < path_.steps.size(); ++i) {
    if (path_.steps[i].last - path_.steps[i].first != 1) {
      throw ConfigurationError(
          with_code(Code::field_path,
                    "field path '{}' of {}: it names several arrays of bytes; name one element of "
                    "each array on the way, as in [0]",
                    path_.text, path_.type->name));
    }
  }
}

std::span<const std::byte> BytesField::read(std::span<const std::byte> message) const {
  std::span<const std::byte> bytes;
  walk_path(message, path_, [&](auto reader, const FieldLayout&, std::size_t count) {
    bytes = reader.take_bytes(count);
  });
  return bytes;
}

TextField::TextField(const Catalog& catalog, std::string_view type, std::string_view path)
    : path_(compile_path(catalog, type, path)) {
  if (!path_.is_text()) {
    throw ConfigurationError(
        with_code(Code::field_path,
                  "field path '{}' of {}: a number is not text; name a field of type string",
                  path_.text, path_.type->name));
  }
}

std::size_t TextField::read(std::span<const std::byte> message,
                            std::vector<std::string_view>& texts) const {
  const std::size_t before = texts.size();
  walk_path(message, path_, [&](auto reader, const FieldLayout&, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      texts.push_back(reader.text());
    }
  });
  return texts.size() - before;
}

}  // namespace spikeloop::messages
