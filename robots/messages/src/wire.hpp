// Walks over the bytes of messages. What stands where depends on the encoding alone; the walk over
// the fields is the same for all, so that another encoding (CDR, with its alignment) is another
// cursor.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::messages {

static_assert(std::endian::native == std::endian::little, "ROS 1 messages are little-endian");

/// Reads ROS 1's serialization: little-endian, packed, lengths of 4 bytes.
/// Every function throws TransportError rather than read outside of the message.
class Ros1Reader {
 public:
  static constexpr bool kPacked = true;

  explicit Ros1Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  double number(Primitive primitive) {
    switch (primitive) {
      case Primitive::boolean:
        return take<std::uint8_t>() == 0 ? 0.0 : 1.0;
      case Primitive::int8:
        return take<std::int8_t>();
      case Primitive::uint8:
        return take<std::uint8_t>();
      case Primitive::int16:
        return take<std::int16_t>();
      case Primitive::uint16:
        return take<std::uint16_t>();
      case Primitive::int32:
        return take<std::int32_t>();
      case Primitive::uint32:
        return take<std::uint32_t>();
      case Primitive::int64:
        return static_cast<double>(take<std::int64_t>());
      case Primitive::uint64:
        return static_cast<double>(take<std::uint64_t>());
      case Primitive::float32:
        return static_cast<double>(take<float>());
      case Primitive::float64:
        return take<double>();
      case Primitive::time: {
        const double seconds = take<std::uint32_t>();
        return seconds + 1e-9 * take<std::uint32_t>();
      }
      case Primitive::duration: {
        const double seconds = take<std::int32_t>();
        return seconds + 1e-9 * take<std::int32_t>();
      }
      default:
        throw std::logic_error("neither a text nor a message is a number");
    }
  }

  /// The number of elements of a variable array; never more than the rest of the message can hold.
  std::size_t length(std::size_t least_element) {
    const std::size_t count = take<std::uint32_t>();
    if (least_element != 0 && count > left() / least_element) {
      fail();
    }
    return count;
  }

  void skip_text() { skip_bytes(take<std::uint32_t>()); }
  void skip_bytes(std::size_t count) {
    if (count > left()) {
      fail();
    }
    position_ += count;
  }
  std::size_t left() const { return bytes_.size() - position_; }

 private:
  template <typename T>
  T take() {
    if (sizeof(T) > left()) {
      fail();
    }
    T value{};
    std::memcpy(&value, bytes_.data() + position_, sizeof(T));
    position_ += sizeof(T);
    return value;
  }

  [[noreturn]] void fail() const {
    throw TransportError("message of " + std::to_string(bytes_.size()) +
                         " bytes is shorter than its type says (at byte " +
                         std::to_string(position_) + ")");
  }

  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
};

/// Writes ROS 1's serialization.
class Ros1Writer {
 public:
  explicit Ros1Writer(std::vector<std::byte>& bytes) : bytes_(&bytes) {}

  /// Whole-number types take the nearest value they can hold; NaN becomes 0.
  void number(Primitive primitive, double value) {
    switch (primitive) {
      case Primitive::boolean:
        return put(static_cast<std::uint8_t>(value != 0.0 && !std::isnan(value)));
      case Primitive::int8:
        return put(whole<std::int8_t>(value));
      case Primitive::uint8:
        return put(whole<std::uint8_t>(value));
      case Primitive::int16:
        return put(whole<std::int16_t>(value));
      case Primitive::uint16:
        return put(whole<std::uint16_t>(value));
      case Primitive::int32:
        return put(whole<std::int32_t>(value));
      case Primitive::uint32:
        return put(whole<std::uint32_t>(value));
      case Primitive::int64:
        return put(whole<std::int64_t>(value));
      case Primitive::uint64:
        return put(whole<std::uint64_t>(value));
      case Primitive::float32:
        return put(static_cast<float>(value));
      case Primitive::float64:
        return put(value);
      case Primitive::time:
      case Primitive::duration:
        return seconds(primitive, value);
      default:
        throw std::logic_error("neither a text nor a message is a number");
    }
  }

  void length(std::size_t count) { put(static_cast<std::uint32_t>(count)); }
  void text(std::string_view value) {
    length(value.size());
    const auto* data = reinterpret_cast<const std::byte*>(value.data());
    bytes_->insert(bytes_->end(), data, data + value.size());
  }

 private:
  template <typename T>
  static T whole(double value) {
    if (std::isnan(value)) {
      return 0;
    }
    const double rounded = std::nearbyint(value);
    constexpr T least = std::numeric_limits<T>::min();
    constexpr T most = std::numeric_limits<T>::max();
    if (rounded <= static_cast<double>(least)) {
      return least;
    }
    return rounded >= static_cast<double>(most) ? most : static_cast<T>(rounded);
  }

  void seconds(Primitive primitive, double value) {
    double whole_seconds = std::floor(value);
    double nanoseconds = std::nearbyint((value - whole_seconds) * 1e9);
    if (nanoseconds >= 1e9) {
      whole_seconds += 1;
      nanoseconds = 0;
    }
    if (primitive == Primitive::time) {
      put(whole<std::uint32_t>(whole_seconds));
    } else {
      put(whole<std::int32_t>(whole_seconds));
    }
    put(whole<std::uint32_t>(nanoseconds));
  }

  template <typename T>
  void put(T value) {
    const auto* data = reinterpret_cast<const std::byte*>(&value);
    bytes_->insert(bytes_->end(), data, data + sizeof(T));
  }

  std::vector<std::byte>* bytes_;
};

template <typename Reader>
void skip_message(Reader& reader, const TypeLayout& type);

template <typename Reader>
void skip_element(Reader& reader, const FieldLayout& field) {
  if (field.primitive == Primitive::message) {
    skip_message(reader, *field.message);
  } else if (field.primitive == Primitive::text) {
    reader.skip_text();
  } else {
    reader.number(field.primitive);
  }
}

template <typename Reader>
std::size_t read_count(Reader& reader, const FieldLayout& field) {
  switch (field.array) {
    case ArrayKind::fixed:
      return field.count;
    case ArrayKind::variable:
      return reader.length(field.element_least);
    default:
      return 1;
  }
}

template <typename Reader>
void skip_elements(Reader& reader, const FieldLayout& field, std::size_t count) {
  if (Reader::kPacked && field.element_bytes) {
    // No product overflows: a count is below 2^32, and a layout's size is limited.
    reader.skip_bytes(count * *field.element_bytes);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    skip_element(reader, field);
  }
}

template <typename Reader>
void skip_message(Reader& reader, const TypeLayout& type) {
  if (Reader::kPacked && type.bytes) {
    reader.skip_bytes(*type.bytes);
    return;
  }
  for (const FieldLayout& field : type.fields) {
    skip_elements(reader, field, read_count(reader, field));
  }
}

}  // namespace spikeloop::messages
