#include "spikeloop/live/stop_flag.hpp"

#include <fcntl.h>
#include <sys/mman.h>

#include <cerrno>

#include "spikeloop/core/error.hpp"
#include "spikeloop/processes/descriptor.hpp"

namespace spikeloop::live {
namespace {

constexpr std::size_t kFlagBytes = sizeof(std::atomic<std::uint32_t>);
static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

}  // namespace

StopFlag::StopFlag(const std::string& folder) {
  const std::string path = folder + "/stop";
  const Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (file.get() < 0) {
    throw FileError("make", path, errno);
  }
  if (const int error = ::posix_fallocate(file.get(), 0, kFlagBytes); error != 0) {
    throw FileError("make", path, error);
  }
  void* const memory =
      ::mmap(nullptr, kFlagBytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, file.get(), 0);
  if (memory == MAP_FAILED) {
    throw FileError("map", path, errno);
  }
  word_ = static_cast<std::atomic<std::uint32_t>*>(memory);
}

StopFlag::~StopFlag() {
  ::munmap(word_, kFlagBytes);
}

}  // namespace spikeloop::live
