// Bytes of a file that somebody else may have written.
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

namespace spikeloop::bag {

/// A file's bytes while it lives.
class Mapping {
 public:
  /// @throws std::runtime_error when it is empty or cannot be read.
  explicit Mapping(const std::string& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status {};
    if (file >= 0 && ::fstat(file, &status) == 0 && status.st_size > 0) {
      size_ = static_cast<std::size_t>(status.st_size);
      bytes_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
    }
    ::close(file);
    if (bytes_ == MAP_FAILED) {
      throw std::runtime_error("it cannot be read");
    }
  }
  ~Mapping() { ::munmap(bytes_, size_); }
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;

  std::string_view bytes() const { return {static_cast<const char*>(bytes_), size_}; }

 private:
  void* bytes_ = MAP_FAILED;
  std::size_t size_ = 0;
};

/// Moves along bytes, never beyond their end. Numbers are little-endian.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : rest_(bytes) {}

  bool at_end() const { return rest_.empty(); }
  std::size_t left() const { return rest_.size(); }
  std::string_view rest() const { return rest_; }
  /// @throws std::runtime_error
  std::string_view take(std::size_t count) {
    if (count > rest_.size()) {
      throw std::runtime_error("a record is cut off");
    }
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }
  template <typename Number = std::uint32_t>
  Number number() {
    Number value = 0;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  /// Bytes behind their number.
  template <typename Number = std::uint32_t>
  std::string_view text() {
    return take(number<Number>());
  }

 private:
  std::string_view rest_;
};

}  // namespace spikeloop::bag
