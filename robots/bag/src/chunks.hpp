// Files whose messages are in compressed chunks.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cursor.hpp"
#include "source.hpp"
#include "unpack.hpp"

namespace spikeloop::bag {

/// Largest chunk in bytes. Writers end a chunk at about 1 MB; a damaged file may contain any size.
inline constexpr std::uint64_t kLargestChunk = 1'000'000'000;

struct Chunk {
  std::string_view stored;
  std::string_view compression;  ///< "zstd", "lz4", "bz2"; empty or "none": not compressed
  std::uint64_t size = 0;        ///< bytes when it is unpacked

  bool is_plain() const { return compression.empty() || compression == "none"; }
};

/// Place::block is the chunk's index, Place::position the message's offset in the unpacked chunk. A
/// message outside of a chunk is a chunk by itself.
struct ChunkedFile {
  ChunkedFile(const std::string& path, std::string name_) : name(std::move(name_)), mapping(path) {}

  std::string name;  ///< for error messages
  Mapping mapping;
  std::vector<Chunk> chunks;
};

/// Adds a chunk to the file, and calls `read_records` with its unpacked bytes.
/// @throws std::runtime_error if the chunk is damaged
template <typename ReadRecords>
void add_chunk(ChunkedFile& file, const Chunk& chunk, ReadRecords&& read_records) {
  if (chunk.size > kLargestChunk || (chunk.is_plain() && chunk.size != chunk.stored.size())) {
    throw std::runtime_error(fmt::format("invalid chunk size of {} bytes", chunk.size));
  }
  file.chunks.push_back(chunk);
  if (chunk.is_plain()) {
    read_records(chunk.stored);
    return;
  }
  const Buffer unpacked = unpack_chunk(chunk.compression, chunk.stored, chunk.size);
  read_records(unpacked.view());
}

/// Reads the messages of a file chunk by chunk.
class ChunkBytes : public Bytes {
 public:
  /// @param message_at content of the message at the begin of these bytes
  ChunkBytes(std::shared_ptr<const ChunkedFile> file,
             std::string_view (*message_at)(std::string_view))
      : file_(std::move(file)), message_at_(message_at) {}

  std::span<const std::byte> read(const Place& place) override {
    const Chunk& chunk = file_->chunks[place.block];
    try {
      if (!chunk.is_plain() && place.block != unpacked_) {
        bytes_ = unpack_chunk(chunk.compression, chunk.stored, chunk.size);
        unpacked_ = place.block;
      }
      const std::string_view bytes = chunk.is_plain() ? chunk.stored : bytes_.view();
      return std::as_bytes(std::span(message_at_(bytes.substr(place.position))));
    } catch (const std::runtime_error& error) {
      fail_damaged(file_->name, error.what());  // the file has changed since it was opened
    }
  }

 private:
  std::shared_ptr<const ChunkedFile> file_;
  std::string_view (*message_at_)(std::string_view);
  Buffer bytes_;
  std::uint32_t unpacked_ = std::numeric_limits<std::uint32_t>::max();
};

}  // namespace spikeloop::bag
