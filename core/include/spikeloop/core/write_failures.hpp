// Files of a run that can no longer be written: the disk is full, or the run folder was deleted.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

namespace spikeloop {

/// Reaction of a run to a file that cannot be written.
enum class OnWriteFailure { stop, proceed };

/// The choices of the key `on_write_failure`, "stop" and "continue".
inline constexpr const char* kOnWriteFailureKey = "on_write_failure";
OnWriteFailure on_write_failure_of(const std::string& choice);
std::string to_text(OnWriteFailure policy);
std::vector<std::string> on_write_failure_choices();

/// "; incomplete: scan.h5, wheels.h5 and 3 more". Empty if there are no files.
std::string list_incomplete(const std::vector<std::string>& paths);

/// Connects the writers of a run's files, in any thread, with the loop. A writer that fails adds
/// its file and writes nothing more; the loop checks.
class WriteFailures {
 public:
  /// `message` contains the path and the reason. Only the first failure of a file counts.
  void add(const std::string& path, const std::string& message);

  /// To be called every tick. Without failures it only reads an atomic variable. Logs a warning
  /// about the first failure if the run proceeds. @throws FileError if it stops.
  void check(OnWriteFailure policy);

  /// True if any file failed.
  bool any() const { return any_.load(std::memory_order_acquire); }
  /// Message of the first failure, and the names of all files that are incomplete.
  std::string text() const;
  /// Paths of the incomplete files, in the order of their failures.
  std::vector<std::string> files() const;

 private:
  mutable std::mutex mutex_;
  std::string first_;
  std::vector<std::string> files_;
  std::atomic<bool> any_{false};
  std::atomic<bool> warned_{false};
};

/// @throws FileError if the open file or folder has been deleted: writes to it would succeed, and
/// their data be lost when it is closed.
void require_not_deleted(int descriptor, const std::string& path);

}  // namespace spikeloop
