// A bounded queue between one writing and one reading thread, without locks, so that neither a
// slow disk nor a signal handler that interrupts the loop can hold up the other side.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace spikeloop::record {

template <typename T>
class Ring {
 public:
  /// Holds `capacity` items, rounded up to a power of two.
  explicit Ring(std::size_t capacity)
      : size_(std::bit_ceil(std::max<std::size_t>(capacity, 2))),
        items_(std::make_unique_for_overwrite<T[]>(size_)) {}

  /// Writer: room for so many items at least.
  std::size_t room() const {
    return size_ - (head_.load(std::memory_order_relaxed) - tail_.load(std::memory_order_acquire));
  }
  std::size_t capacity() const { return size_; }

  /// Writer: puts item i of a batch that publish() makes visible; i < room().
  void put(std::size_t i, const T& item) {
    items_[(head_.load(std::memory_order_relaxed) + i) & (size_ - 1)] = item;
  }
  void publish(std::size_t count) {
    head_.store(head_.load(std::memory_order_relaxed) + count, std::memory_order_release);
  }

  /// Reader: moves everything to the end of `out`; returns how many.
  std::size_t drain(std::vector<T>& out) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    const std::size_t count = head_.load(std::memory_order_acquire) - tail;
    const std::size_t first = std::min(count, size_ - (tail & (size_ - 1)));
    const T* begin = items_.get() + (tail & (size_ - 1));
    out.insert(out.end(), begin, begin + first);
    out.insert(out.end(), items_.get(), items_.get() + (count - first));
    tail_.store(tail + count, std::memory_order_release);
    return count;
  }

 private:
  std::size_t size_;
  std::unique_ptr<T[]> items_;
  alignas(64) std::atomic<std::size_t> head_{0};  // next to write
  alignas(64) std::atomic<std::size_t> tail_{0};  // next to read
};

}  // namespace spikeloop::record
