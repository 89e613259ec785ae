// Walks over the bytes of messages. What stands where depends on the dialect's encoding alone; the
// walk over the fields is the same for both.
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
#include <type_traits>
#include <vector>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/number.hpp"

namespace spikeloop::messages {

static_assert(std::endian::native == std::endian::little, "messages are little-endian");

/// ROS 2's bytes begin with the name of the encoding, XCDR1 in little endian, and two bytes of
/// options, whose last two bits count the bytes of padding at the message's end.
inline constexpr std::size_t kEncapsulation = 4;

/// Reads a dialect's serialization, little-endian with lengths of 4 bytes. ROS 1: packed. ROS 2:
/// XCDR1, where each number stands at a multiple of its size, counted from behind the
/// encapsulation, and texts end in a zero byte, which counts.
/// Every function throws TransportError rather than read outside of the message.
template <Dialect kDialect>
class WireReader {
 public:
  /// @throws TransportError for another encoding.
  explicit WireReader(std::span<const std::byte> bytes) : bytes_(bytes) {
    if constexpr (kDialect == Dialect::ros2) {
      open_encapsulation();
    }
  }

  double number(Primitive primitive) {
    if (is_time(primitive)) {
      const double seconds = number(half_of_time(primitive, false));
      return seconds + 1e-9 * number(half_of_time(primitive, true));
    }
    return with_number(primitive, [&]<typename T>(T /*type*/) {
      if constexpr (std::is_same_v<T, bool>) {
        return take<std::uint8_t>() == 0 ? 0.0 : 1.0;
      } else {
        return static_cast<double>(take<T>());
      }
    });
  }

  /// The types of a time's two numbers.
  static Primitive half_of_time(Primitive primitive, bool nanoseconds) {
    if constexpr (kDialect == Dialect::ros2) {
      return nanoseconds ? Primitive::uint32 : Primitive::int32;
    }
    return primitive == Primitive::duration ? Primitive::int32 : Primitive::uint32;
  }

  /// The number of elements of a variable array; never more than the rest of the message can hold.
  std::size_t length(std::size_t least_element) {
    const std::size_t count = take<std::uint32_t>();
    if (least_element != 0 && count > left() / least_element) {
      fail();
    }
    return count;
  }

  /// Valid as long as the message's bytes.
  std::string_view text() {
    const std::span<const std::byte> bytes = take_bytes(take<std::uint32_t>());
    std::string_view value(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (kDialect == Dialect::ros2 && !value.empty()) {
      if (value.back() != '\0') {
        throw TransportError(with_code(
            Code::damaged_message,
            "message of {} bytes has a text that does not end in a zero byte (before byte {})",
            bytes_.size(), position_));
      }
      value.remove_suffix(1);
    }
    return value;
  }

  std::span<const std::byte> take_bytes(std::size_t count) {
    if (count > left()) {
      fail();
    }
    position_ += count;
    return bytes_.subspan(position_ - count, count);
  }
  void skip_bytes(std::size_t count) { take_bytes(count); }

  /// Goes to the next place where something of this alignment may stand.
  void align(std::size_t alignment) {
    if constexpr (kDialect == Dialect::ros2) {
      const std::size_t beyond = (position_ - kEncapsulation) & (alignment - 1);
      if (beyond != 0) {
        skip_bytes(alignment - beyond);
      }
    }
  }

  std::size_t left() const { return bytes_.size() - position_; }

 private:
  template <typename T>
  T take() {
    align(sizeof(T));
    T value{};
    std::memcpy(&value, take_bytes(sizeof(T)).data(), sizeof(T));
    return value;
  }

  void open_encapsulation() {
    const std::size_t size = bytes_.size();
    const auto at = [&](std::size_t i) { return std::to_integer<unsigned>(bytes_[i]); };
    if (size < kEncapsulation) {
      throw TransportError(with_code(Code::damaged_message,
                                     "message of {} bytes is too short to say how it is encoded",
                                     size));
    }
    if (at(0) != 0 || at(1) != 1) {
      throw TransportError(with_code(Code::damaged_message,
                                     "message of {} bytes has encoding {}, not 1 (plain CDR in "
                                     "little endian), the one that ROS 2 has",
                                     size, 256 * at(0) + at(1)));
    }
    // Without its padding, as a transport may have handed it over, the size tells.
    const std::size_t padding = size % 4 == 0 ? at(3) & 3u : 0;
    position_ = kEncapsulation;
    bytes_ = bytes_.first(size - std::min(padding, size - kEncapsulation));
  }

  [[noreturn]] void fail() const {
    throw TransportError(with_code(Code::damaged_message,
                                   "message of {} bytes is shorter than its type says (at byte {})",
                                   bytes_.size(), position_));
  }

  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
};

using Ros1Reader = WireReader<Dialect::ros1>;
using Ros2Reader = WireReader<Dialect::ros2>;

/// What `work` returns when it gets a reader of the message.
template <typename Work>
auto with_reader(Dialect dialect, std::span<const std::byte> message, Work&& work) {
  if (dialect == Dialect::ros2) {
    Ros2Reader reader(message);
    return work(reader);
  }
  Ros1Reader reader(message);
  return work(reader);
}

/// Writes what WireReader reads.
template <Dialect kDialect>
class WireWriter {
 public:
  using Reader = WireReader<kDialect>;

  /// @param bytes what it writes to; empty
  explicit WireWriter(std::vector<std::byte>& bytes) : bytes_(&bytes) {
    if constexpr (kDialect == Dialect::ros2) {
      bytes.assign({std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}});
    }
  }

  /// Whole-number types take the nearest value they can hold; NaN becomes 0.
  void number(Primitive primitive, double value) {
    if (is_time(primitive)) {
      return seconds(primitive, value);
    }
    with_number(primitive, [&]<typename T>(T /*type*/) {
      if constexpr (std::is_same_v<T, bool>) {
        put(value != 0.0 && !std::isnan(value));
      } else if constexpr (std::is_floating_point_v<T>) {
        put(static_cast<T>(value));
      } else {
        put(whole<T>(value));
      }
    });
  }

  void length(std::size_t count) { put(static_cast<std::uint32_t>(count)); }
  /// Elements of one byte each.
  void bytes(std::span<const std::byte> values) {
    bytes_->insert(bytes_->end(), values.begin(), values.end());
  }
  void text(std::string_view value) {
    length(value.size() + (kDialect == Dialect::ros2 ? 1 : 0));
    const auto* data = reinterpret_cast<const std::byte*>(value.data());
    bytes_->insert(bytes_->end(), data, data + value.size());
    if constexpr (kDialect == Dialect::ros2) {
      bytes_->push_back(std::byte{0});
    }
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
    number(Reader::half_of_time(primitive, false), whole_seconds);
    put(whole<std::uint32_t>(nanoseconds));
  }

  void align(std::size_t alignment) {
    if constexpr (kDialect == Dialect::ros2) {
      const std::size_t beyond = (bytes_->size() - kEncapsulation) & (alignment - 1);
      bytes_->resize(bytes_->size() + (beyond == 0 ? 0 : alignment - beyond));
    }
  }

  template <typename T>
  void put(T value) {
    align(sizeof(T));
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
    reader.text();
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
  if (count == 0) {
    return;
  }
  if (field.element_bytes) {
    reader.align(field.alignment);
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
  if (type.bytes) {
    reader.align(type.alignment);
    reader.skip_bytes(*type.bytes);
    return;
  }
  for (const FieldLayout& field : type.fields) {
    skip_elements(reader, field, read_count(reader, field));
  }
}

}  // namespace spikeloop::messages
