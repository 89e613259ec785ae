#include "structure.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>

#include "cursor.hpp"

namespace spikeloop::bag {
namespace {

constexpr std::string_view kVersion = "#ROSBAG V2.0\n";

// http://wiki.ros.org/Bags/Format/2.0
constexpr char kMessage = 2;
constexpr char kFileHeader = 3;
constexpr char kIndex = 4;
constexpr char kChunk = 5;
constexpr char kChunkInfo = 6;
constexpr char kConnection = 7;
constexpr std::size_t kIndexEntry = 12;  // a time, and an offset in the chunk

using Fields = std::map<std::string_view, std::string_view>;

struct Record {
  Fields fields;
  std::string_view data;

  std::string_view field(std::string_view name, std::size_t size) const {
    const auto found = fields.find(name);
    if (found == fields.end() || found->second.size() != size) {
      throw std::runtime_error(fmt::format("a record has no right field '{}'", name));
    }
    return found->second;
  }
  char kind() const { return field("op", 1).front(); }
  std::uint64_t position(std::string_view name) const {
    return Cursor(field(name, 8)).number<std::uint64_t>();
  }
};

Fields fields_of(std::string_view text) {
  Fields fields;
  Cursor header(text);
  while (!header.at_end()) {
    const std::string_view field = header.text();
    const auto equals = field.find('=');
    if (equals == std::string_view::npos) {
      throw std::runtime_error("a record's header cannot be read");
    }
    fields[field.substr(0, equals)] = field.substr(equals + 1);
  }
  return fields;
}

Record next_record(Cursor& cursor) {
  Record record;
  record.fields = fields_of(cursor.text());
  record.data = cursor.text();
  return record;
}

/// Appends the positions of a connection's messages in a chunk.
void check_index(const Record& index, const Record& chunk, std::uint64_t chunk_at,
                 std::vector<BagPosition>& positions) {
  constexpr std::uint32_t kLargest = 1'000'000'000;  // bytes; rosbag begins another after 768 kB
  const auto size = Cursor(chunk.field("size", 4)).number();
  const bool plain = chunk.fields.contains("compression") &&
                     chunk.fields.at("compression") == std::string_view("none");
  if (size > kLargest || (plain && size != chunk.data.size())) {
    throw std::runtime_error(fmt::format("a chunk says that it has {} bytes", size));
  }
  std::set<std::uint32_t> seen;
  Cursor entries(index.data);
  for (auto count = Cursor(index.field("count", 4)).number(); count > 0; --count) {
    Cursor entry(entries.take(kIndexEntry));
    const auto seconds = entry.number();
    const auto nanoseconds = entry.number();
    const auto offset = entry.number();
    positions.push_back({seconds, nanoseconds, chunk_at, offset});
    if (offset >= size || (plain && offset >= chunk.data.size())) {
      throw std::runtime_error("its index leads outside of a chunk");
    }
    if (plain && seen.insert(offset).second) {
      Cursor cursor(chunk.data.substr(offset));
      if (next_record(cursor).kind() != kMessage) {
        throw std::runtime_error("its index leads to something that is not a message");
      }
    }
  }
}

}  // namespace

BagStructure check_structure(const std::string& path) {
  BagStructure structure;
  const Mapping file(path);
  if (!file.bytes().starts_with(kVersion)) {
    return structure;  // an older format, which rosbag knows
  }
  Cursor cursor(file.bytes());
  cursor.take(kVersion.size());
  const Record header = next_record(cursor);
  const std::uint64_t index = header.kind() == kFileHeader ? header.position("index_pos") : 0;
  if (index == 0) {
    structure.has_index = false;
    return structure;
  }
  std::set<std::uint64_t> chunks;
  std::optional<Record> chunk;
  std::uint64_t chunk_at = 0;
  bool found = false;
  while (!cursor.at_end()) {
    const std::uint64_t at = file.bytes().size() - cursor.left();
    found = found || at == index;
    Record record = next_record(cursor);
    if (record.kind() == kChunk) {
      chunks.insert(at);
      chunk = std::move(record);
      chunk_at = at;
    } else if (record.kind() == kIndex && chunk) {
      const auto connection = Cursor(record.field("conn", 4)).number();
      check_index(record, *chunk, chunk_at, structure.positions[connection]);
    } else if (record.kind() == kConnection) {
      fields_of(record.data);
    } else if (record.kind() == kChunkInfo && !chunks.contains(record.position("chunk_pos"))) {
      throw std::runtime_error("its index knows a chunk that is not there");
    }
  }
  if (!found && index != file.bytes().size()) {
    throw std::runtime_error("its index is not where it should be");
  }
  return structure;
}

}  // namespace spikeloop::bag
