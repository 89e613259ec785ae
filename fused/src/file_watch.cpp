#include "file_watch.hpp"

#include <fcntl.h>

#include "spikeloop/core/error.hpp"

namespace spikeloop::fused {

FileWatch::FileWatch(const RunOptions& options, OnWriteFailure policy)
    : folder_(options.folder), failures_(*options.failures), policy_(policy) {
  if (!folder_.empty()) {
    open_folder_ = Descriptor(::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  }
}

void FileWatch::check(TimeNs now) {
  constexpr TimeNs kPeriod = kNsPerSecond / 10;
  if (now >= next_ && open_folder_.get() >= 0) {
    next_ = now + kPeriod;
    try {
      require_not_deleted(open_folder_.get(), folder_);
    } catch (const FileError& error) {
      failures_.add(folder_, error.what());
    }
  }
  failures_.check(policy_);
}

}  // namespace spikeloop::fused
