#include "writer.hpp"

#include <malloc.h>

#include <algorithm>
#include <ctime>
#include <set>
#include <utility>

#include "spikeloop/core/background.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop::record {

void Wake::wait() noexcept {
  constexpr long kLongestNs = 50'000'000;
  timespec until{};
  clock_gettime(CLOCK_MONOTONIC, &until);
  until.tv_nsec += kLongestNs;
  if (until.tv_nsec >= kNsPerSecond) {
    until.tv_nsec -= kNsPerSecond;
    ++until.tv_sec;
  }
  sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &until);
  while (sem_trywait(&semaphore_) == 0) {
  }
}

std::shared_ptr<Writer> Writer::shared() {
  static std::mutex mutex;
  static std::weak_ptr<Writer> known;
  const std::lock_guard lock(mutex);
  auto writer = known.lock();
  if (!writer) {
    writer = std::make_shared<Writer>();
    known = writer;
  }
  return writer;
}

Writer::Writer() : thread_(background_thread([this] { run(); })) {}

Writer::~Writer() {
  stop_.store(true);
  wake_->post();
  thread_.join();
}

void Writer::add(std::shared_ptr<WrittenFile> file) {
  const std::lock_guard lock(mutex_);
  files_.push_back(std::move(file));
}

void Writer::return_memory(bool all_patient) {
  constexpr std::chrono::seconds kPeriod{10};
  const auto now = std::chrono::steady_clock::now();
  if (all_patient && now - returned_ > kPeriod) {
    returned_ = now;
    malloc_trim(0);
  }
}

void Writer::run() {
  while (!stop_.load()) {
    wake_->wait();
    std::vector<std::shared_ptr<WrittenFile>> files;
    {
      const std::lock_guard lock(mutex_);
      files = files_;
    }
    std::set<const WrittenFile*> closed;
    for (const auto& file : files) {
      if (!file->serve(files.size())) {
        closed.insert(file.get());
      }
    }
    return_memory(std::ranges::all_of(files, [](const auto& file) { return file->is_patient(); }));
    const std::lock_guard lock(mutex_);
    std::erase_if(files_, [&](const auto& file) { return closed.contains(file.get()); });
  }
}

}  // namespace spikeloop::record
