// A Python of its own, which ends with this process.
#pragma once

#include <signal.h>

#include <string>
#include <vector>

namespace spikeloop {

/// Signals that would end this process wait until this is gone, so that what it has made (a child,
/// a folder) goes before it does. Those that are caught, ignored or waited for elsewhere are left
/// alone.
class HeldSignals {
 public:
  HeldSignals();
  ~HeldSignals();
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;

  /// Whether one of them has come.
  bool any() const;
  /// The thread's mask without them.
  const sigset_t& before() const { return before_; }

 private:
  sigset_t held_{};
  sigset_t before_{};
};

/// Runs words[0] with our package on its path. Its exit code; 128 + the signal that ended it. What
/// it prints goes to the error stream. It is killed when one of the held signals comes, and when
/// this process is. @throws FileError when it cannot be started
int run_python(std::vector<std::string> words, const HeldSignals& held);

}  // namespace spikeloop
