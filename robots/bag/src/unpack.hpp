// Compressed chunks, messages and files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace spikeloop::bag {

/// Memory that is not cleared: a damaged file may claim a size that it does not have.
class Buffer {
 public:
  Buffer() = default;
  explicit Buffer(std::size_t size)
      : bytes_(std::make_unique_for_overwrite<char[]>(size)), size_(size) {}
  char* data() { return bytes_.get(); }
  std::size_t size() const { return size_; }
  std::string_view view() const { return {bytes_.get(), size_}; }

 private:
  std::unique_ptr<char[]> bytes_;
  std::size_t size_ = 0;
};

/// Unpacks a chunk of an MCAP file or a bag by "zstd", "lz4" or "bz2". It may consist of several
/// frames, and frames need not state their size. "lz4" may also be a block without a frame.
/// @throws std::runtime_error: damaged, or not `size` bytes
Buffer unpack_chunk(std::string_view compression, std::string_view stored, std::uint64_t size);

bool is_zstd(std::string_view bytes);
/// Unpacks a message of `ros2 bag record --compression-mode message`.
/// @throws std::runtime_error if it is damaged or cut off, or longer than messages may be
std::string unpack_message(std::string_view stored);

/// Contents of a file that is compressed as a whole, as `--compression-mode file` does, in a
/// temporary file.
class UnpackedFile {
 public:
  /// A file that ends too early is unpacked as far as possible. @throws FileError
  explicit UnpackedFile(const std::string& packed);
  /// Removes the name of the file. A source that has opened the file can still read it.
  ~UnpackedFile();
  UnpackedFile(const UnpackedFile&) = delete;
  UnpackedFile& operator=(const UnpackedFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace spikeloop::bag
