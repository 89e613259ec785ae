#include "spikeloop/status/supervision.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/processes/descriptor.hpp"

namespace spikeloop::status {

struct SupervisionPage {
  std::atomic<TimeNs> beat;  ///< wall time of the newest beat
  std::atomic<bool> suspended;
  std::atomic<int> robots;
};
static_assert(std::atomic<TimeNs>::is_always_lock_free && std::atomic<bool>::is_always_lock_free &&
              std::atomic<int>::is_always_lock_free);

namespace {

/// nullptr on failure, with the reason in errno.
SupervisionPage* map_page(int fd) {
  void* const memory =
      mmap(nullptr, sizeof(SupervisionPage), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  return memory == MAP_FAILED ? nullptr : static_cast<SupervisionPage*>(memory);
}

void unmap_page(SupervisionPage* page) {
  if (page != nullptr) {
    munmap(page, sizeof(SupervisionPage));
  }
}

}  // namespace

Supervision::Supervision(const std::string& path) {
  const Descriptor file{
      open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600)};
  if (file.get() < 0) {
    throw FileError("make", path, errno);
  }
  // Allocate now: if shared memory is full, the first beat would raise SIGBUS.
  if (const int error = posix_fallocate(file.get(), 0, sizeof(SupervisionPage)); error != 0) {
    throw FileError("make", path, error);
  }
  page_ = map_page(file.get());
  if (page_ == nullptr) {
    throw FileError("map", path, errno);
  }
  beat(wall_now());
}

Supervision::~Supervision() {
  unmap_page(page_);
}

void Supervision::beat(TimeNs now) {
  page_->beat.store(now);
}

void Supervision::suspend(bool suspended) {
  page_->suspended.store(suspended);
}

int Supervision::robots() const {
  return page_->robots.load();
}

SupervisedRobot::SupervisedRobot() {
  const char* const path = std::getenv(kSupervisionVariable);
  if (path == nullptr || *path == '\0') {
    return;
  }
  const Descriptor file{open(path, O_RDWR | O_NOFOLLOW | O_CLOEXEC)};
  struct stat status {};
  const bool whole = file.get() >= 0 && fstat(file.get(), &status) == 0 &&
                     status.st_size >= static_cast<off_t>(sizeof(SupervisionPage));
  page_ = whole ? map_page(file.get()) : nullptr;
  if (page_ != nullptr) {
    ++page_->robots;
  }
}

SupervisedRobot::~SupervisedRobot() {
  unmap_page(page_);
}

SupervisedRobot::State SupervisedRobot::state(TimeNs now, TimeNs deadline) const {
  if (page_ == nullptr) {
    return State::supervised;
  }
  if (page_->suspended.load()) {
    return State::suspended;
  }
  return now - page_->beat.load() > deadline ? State::silent : State::supervised;
}

void SupervisedRobot::release() {
  if (page_ != nullptr && !released_.exchange(true)) {
    --page_->robots;
  }
}

}  // namespace spikeloop::status
