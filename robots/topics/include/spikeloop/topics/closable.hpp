// A function that another thread calls, until it is closed.
#pragma once

#include <functional>
#include <mutex>
#include <utility>

namespace spikeloop::topics {

template <typename... Arguments>
class Closable {
 public:
  explicit Closable(std::function<void(Arguments...)> function) : function_(std::move(function)) {}

  void call(Arguments... arguments) {
    const std::lock_guard lock(mutex_);
    if (function_) {
      function_(arguments...);
    }
  }
  /// Waits for a running call. Later calls do nothing.
  void close() {
    const std::lock_guard lock(mutex_);
    function_ = nullptr;
  }

 private:
  std::mutex mutex_;
  std::function<void(Arguments...)> function_;
};

}  // namespace spikeloop::topics
