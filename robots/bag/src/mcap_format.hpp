// Records of MCAP files (https://mcap.dev/spec): an opcode, the length of the content in 8 bytes,
// the content.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace spikeloop::bag::mcap {

inline constexpr std::string_view kMagic = "\x89MCAP0\r\n";

enum class Op : std::uint8_t {
  header = 1,
  footer,
  schema,
  channel,
  message,
  chunk,
  message_index,
  chunk_index,
  attachment,
  attachment_index,
  statistics,
  metadata,
  metadata_index,
  summary_offset,
  data_end,
};

inline constexpr std::size_t kRecordHead = 9;  // bytes: opcode and length

/// The content of a record, field by field.
class Content {
 public:
  template <typename Number>
  Content& number(Number value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Content& raw(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  /// Bytes behind their number.
  template <typename Number = std::uint32_t>
  Content& text(std::string_view bytes) {
    return number(static_cast<Number>(bytes.size())).raw(bytes);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Appends a record.
inline void append(std::string& to, Op op, std::string_view content) {
  const auto length = static_cast<std::uint64_t>(content.size());
  to += static_cast<char>(op);
  to.append(reinterpret_cast<const char*>(&length), sizeof length);
  to += content;
}

/// As every checksum in a file. 0: none.
inline std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      ::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace spikeloop::bag::mcap
