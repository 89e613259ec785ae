// Arrays of node state in huge pages: a population of a million neurons is visited all over in
// every tick, and with pages of 4 kB looking up the pages takes longer than the memory.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

namespace spikeloop {

template <typename T>
struct LargeAllocator {
  using value_type = T;
  static constexpr std::size_t kHugePage = std::size_t{1} << 21;

  LargeAllocator() = default;
  template <typename Other>
  explicit LargeAllocator(const LargeAllocator<Other>& /*other*/) {}

  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    const std::size_t alignment = bytes >= kHugePage ? kHugePage : 64;
    void* const memory =
        std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
    if (memory == nullptr) {
      throw std::bad_alloc();
    }
    if (alignment == kHugePage) {
      ::madvise(memory, bytes, MADV_HUGEPAGE);  // an advice: without huge pages all works as well
    }
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t /*count*/) { std::free(memory); }

  template <typename Other>
  bool operator==(const LargeAllocator<Other>& /*other*/) const {
    return true;
  }
};

template <typename T>
using LargeArray = std::vector<T, LargeAllocator<T>>;

}  // namespace spikeloop
