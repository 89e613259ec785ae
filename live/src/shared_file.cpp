#include "shared_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "spikeloop/core/error.hpp"

namespace spikeloop::live {
namespace {

constexpr std::uint64_t kMagic = 0x31'65'76'69'6c'6b'70'73;  // "spklive1"
constexpr std::size_t kWord = sizeof(std::uint64_t);
constexpr std::size_t kHeaderBytes = 4096;
static_assert(sizeof(Header) <= kHeaderBytes);
static_assert(kFeedBytes == kHeaderBytes + kTextBytes + kRingBytes);
static_assert(std::atomic<double>::is_always_lock_free);

}  // namespace

SharedFile::SharedFile(const std::string& path, std::size_t ring_bytes)
    : path_(path),
      file_(::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600)),
      size_(kHeaderBytes + kTextBytes + ring_bytes),
      ring_words_(ring_bytes / kWord) {
  if (file_.get() < 0) {
    throw FileError("make", path_, errno);
  }
  // Memory that is not there would be found missing in the middle of a run.
  if (const int error = ::posix_fallocate(file_.get(), 0, static_cast<off_t>(size_)); error != 0) {
    throw FileError("make", path_, error);
  }
  map();
  header().ring_words = ring_words_;
  header().magic = kMagic;
}

SharedFile::SharedFile(const std::string& path)
    : path_(path), file_(::open(path.c_str(), O_RDWR | O_CLOEXEC)) {
  struct stat status {};
  if (file_.get() < 0 || ::fstat(file_.get(), &status) != 0) {
    throw FileError("open", path_, errno);
  }
  size_ = static_cast<std::size_t>(status.st_size);
  if (size_ <= kHeaderBytes + kTextBytes) {
    throw FileError("read", path_, EINVAL);
  }
  map();
  ring_words_ = (size_ - kHeaderBytes - kTextBytes) / kWord;
  if (header().magic != kMagic || header().ring_words != ring_words_) {
    ::munmap(memory_, size_);
    throw FileError("read", path_, EINVAL);
  }
}

void SharedFile::map() {
  memory_ = ::mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_SHARED, file_.get(), 0);
  if (memory_ == MAP_FAILED) {
    throw FileError("map", path_, errno);
  }
}

SharedFile::~SharedFile() {
  ::munmap(memory_, size_);
}

bool SharedFile::add_text(std::string_view line) {
  const std::uint64_t begin = header().text_bytes.load(std::memory_order_relaxed);
  full_ = full_ || begin + line.size() > kTextBytes;
  if (full_) {
    return false;
  }
  std::memcpy(static_cast<char*>(memory_) + kHeaderBytes + begin, line.data(), line.size());
  header().text_bytes.store(begin + line.size(), std::memory_order_release);
  return true;
}

std::string_view SharedFile::text() const {
  return {static_cast<const char*>(memory_) + kHeaderBytes,
          std::min<std::uint64_t>(header().text_bytes.load(std::memory_order_acquire), kTextBytes)};
}

std::uint64_t& SharedFile::word(std::uint64_t position) {
  auto* const ring = reinterpret_cast<std::uint64_t*>(static_cast<std::byte*>(memory_) +
                                                      kHeaderBytes + kTextBytes);
  return ring[position % ring_words_];
}

void SharedFile::store(std::uint64_t position, std::uint64_t value) {
  std::atomic_ref(word(position)).store(value, std::memory_order_relaxed);
}

void SharedFile::store(std::uint64_t position, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    std::uint64_t value = 0;
    const std::size_t size = std::min(bytes.size(), kWord);
    std::memcpy(&value, bytes.data(), size);
    store(position++, value);
    bytes = bytes.subspan(size);
  }
}

void SharedFile::load(std::uint64_t position, std::span<std::uint64_t> words) {
  for (std::uint64_t& value : words) {
    value = std::atomic_ref(word(position++)).load(std::memory_order_relaxed);
  }
}

}  // namespace spikeloop::live
