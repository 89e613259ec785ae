// The memory that a Feed and a FeedReader share.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "spikeloop/live/feed.hpp"
#include "spikeloop/processes/descriptor.hpp"

namespace spikeloop::live {

inline constexpr std::size_t kTextBytes = std::size_t{2} << 20;

struct Header {
  std::uint64_t magic;
  std::uint64_t ring_words;
  // Words that were written since the begin. While a record is written `claimed` is ahead of
  // `written`: what lies a ring behind it is being overwritten.
  std::atomic<std::uint64_t> claimed;
  std::atomic<std::uint64_t> written;
  std::atomic<std::uint64_t> text_bytes;
  std::atomic<std::uint64_t> left_out;  // bytes of messages that are too large
  std::atomic<std::uint32_t> beginnings;
  std::atomic<std::uint64_t> begun_at;  // words, as `written`
  // By the view.
  std::atomic<std::int64_t> seen_at;  // wall time
  std::atomic<std::uint32_t> watched;
  std::atomic<std::uint32_t> paused;
  std::atomic<std::uint64_t> steps;
  std::atomic<double> speed;
  std::atomic<std::uint32_t> all_changes;
  struct {
    std::atomic<std::uint32_t> changes;
    std::atomic<double> value;
  } parameters[kMostParameters];
};

class SharedFile {
 public:
  /// Makes it. @throws FileError.
  SharedFile(const std::string& path, std::size_t ring_bytes);
  /// Opens it. @throws FileError.
  explicit SharedFile(const std::string& path);
  ~SharedFile();
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  Header& header() { return *static_cast<Header*>(memory_); }
  const Header& header() const { return *static_cast<const Header*>(memory_); }
  std::size_t ring_words() const { return ring_words_; }

  /// False when there is no room, then and later: lines are counted.
  bool add_text(std::string_view line);
  std::string_view text() const;

  /// Words of the ring by their position since the begin; the other side may use them meanwhile.
  void store(std::uint64_t position, std::span<const std::byte> bytes);
  void store(std::uint64_t position, std::uint64_t word);
  void load(std::uint64_t position, std::span<std::uint64_t> words);

 private:
  void map();
  std::uint64_t& word(std::uint64_t position);

  std::string path_;
  Descriptor file_;
  void* memory_ = nullptr;
  std::size_t size_ = 0;
  std::size_t ring_words_ = 0;
  bool full_ = false;  // no more text
};

}  // namespace spikeloop::live
