// The thread that writes all recordings of the process. More threads would not be faster: HDF5
// serves one thread at a time.
#pragma once

#include <semaphore.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace spikeloop::record {

/// Wakes the writer; async-signal-safe. Shared with streams, which may outlive the writer.
class Wake {
 public:
  Wake() { sem_init(&semaphore_, 0, 0); }
  ~Wake() { sem_destroy(&semaphore_); }
  Wake(const Wake&) = delete;
  Wake& operator=(const Wake&) = delete;

  void post() noexcept { sem_post(&semaphore_); }
  /// Returns after post(), or 50 ms. Several calls of post() count as one.
  void wait() noexcept;

 private:
  sem_t semaphore_;
};

/// A file that the writer's thread writes.
class WrittenFile {
 public:
  virtual ~WrittenFile() = default;
  /// Writer's thread, after every wake: moves data towards the disk. `files` is the number of files
  /// that share the thread. False once the file is closed.
  virtual bool serve(std::size_t files) = 0;
  /// True if the loop may wait for the writer.
  virtual bool is_patient() const = 0;
};

class Writer {
 public:
  /// The writer of the process. Its thread ends with the last owner, who must not be a WrittenFile.
  static std::shared_ptr<Writer> shared();

  Writer();
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void add(std::shared_ptr<WrittenFile> file);
  const std::shared_ptr<Wake>& wake() const { return wake_; }

 private:
  void run();
  /// Buffers of many sizes fragment the memory of a long run. Returning it delays other threads a
  /// little, so a loop that follows the wall clock goes without.
  void return_memory(bool all_patient);

  std::shared_ptr<Wake> wake_ = std::make_shared<Wake>();
  std::mutex mutex_;
  std::vector<std::shared_ptr<WrittenFile>> files_;
  std::chrono::steady_clock::time_point returned_ = std::chrono::steady_clock::now();
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace spikeloop::record
