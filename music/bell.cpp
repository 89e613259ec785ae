// Part of the library that `spikeloop run` preloads into programs of any kind: it needs libc alone.
#include "bell.hpp"

#include <fcntl.h>
#include <limits.h>
#include <linux/futex.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>

namespace spikeloop::bell {
namespace {

/// On a cache line of its own: others ring theirs while we look at ours.
struct alignas(64) Bell {
  std::atomic<std::uint32_t> rings;
  std::atomic<std::uint32_t> asleep;  ///< threads of its process
  std::atomic<std::uint32_t> exists;  ///< its process has this library, and rings
};

Bell* bells = nullptr;  ///< one per rank
int size = 0;
int own = kNobody;
thread_local int partner = kNobody;
thread_local bool exchanging = false;
thread_local bool begun = false;

int number(const char* variable) {
  const char* const text = getenv(variable);
  return text == nullptr ? kNobody : atoi(text);
}

/// The bells are a file beside the launcher's socket, in the folder of the job. mpirun inside of a
/// program has a job of its own. Reads the variables before the program can change them.
[[gnu::constructor]] void open_bells() {
  const char* const status = getenv("SPIKELOOP_STATUS");
  const char* const slash = status == nullptr ? nullptr : strrchr(status, '/');
  const char* const job = getenv("PMIX_NAMESPACE");
  size = number("OMPI_COMM_WORLD_SIZE");
  own = number("OMPI_COMM_WORLD_RANK");
  if (slash == nullptr || job == nullptr || own < 0 || own >= size) {
    return;
  }
  char path[PATH_MAX];
  snprintf(path, sizeof path, "%.*s/bells-%s", static_cast<int>(slash - status), status, job);
  const int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  const auto length = static_cast<std::size_t>(size) * sizeof(Bell);
  if (file >= 0 && posix_fallocate(file, 0, static_cast<off_t>(length)) == 0) {
    void* const place = mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    bells = place == MAP_FAILED ? nullptr : static_cast<Bell*>(place);
  }
  close(file);
  if (bells != nullptr) {
    bells[own].exists = 1;
  }
}

}  // namespace

bool exists() {
  return bells != nullptr;
}

std::uint32_t rings() {
  return bells == nullptr ? 0 : bells[own].rings.load();
}

void sleep(std::uint32_t seen, std::int64_t length) {
  const timespec time{.tv_sec = 0, .tv_nsec = length};
  Bell& bell = bells[own];
  // Who rings counts first, and looks then who sleeps: no ring is missed.
  bell.asleep.fetch_add(1);
  syscall(SYS_futex, &bell.rings, FUTEX_WAIT, seen, &time, nullptr, 0);
  bell.asleep.fetch_sub(1);
}

void begin(int rank) {
  exchanging = bells != nullptr && rank >= 0 && rank < size;
  if (exchanging) {
    partner = rank;
    begun = true;
  }
}

void end() {
  exchanging = false;
}

bool will_be_rung() {
  return exchanging && bells[partner].exists.load() != 0;
}

bool has_begun() {
  const bool result = begun;
  begun = false;
  return result;
}

void ring_partner() {
  if (partner == kNobody) {  // as long as nothing has begun
    return;
  }
  Bell& bell = bells[partner];
  bell.rings.fetch_add(1);
  if (bell.asleep.load() > 0) {
    const int before = errno;
    syscall(SYS_futex, &bell.rings, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
    errno = before;
  }
}

}  // namespace spikeloop::bell
