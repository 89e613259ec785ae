// STOP of the live view, for all processes of a run.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

namespace spikeloop::live {

/// One word in the file `stop` of the folder of the feeds: shared memory that exists before STOP is
/// pressed. Pressing it cannot fail, waits for nothing, and holds for processes that begin later.
/// Thread safe.
class StopFlag {
 public:
  /// Opens the file, or creates it. @throws FileError
  explicit StopFlag(const std::string& folder);
  ~StopFlag();
  StopFlag(const StopFlag&) = delete;
  StopFlag& operator=(const StopFlag&) = delete;

  void press(bool pressed) { word_->store(pressed ? 1 : 0); }
  bool is_pressed() const { return word_->load() != 0; }

 private:
  std::atomic<std::uint32_t>* word_;
};

}  // namespace spikeloop::live
