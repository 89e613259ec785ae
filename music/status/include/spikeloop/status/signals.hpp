// Signals of a MUSIC program. SIGUSR1, which mpirun forwards: leave the loop, finalize, exit 0.
// SIGTERM, or the end of mpirun: run the termination hooks, then _exit(143) at once, because MUSIC
// does not come to an end in the second that mpirun leaves.
#pragma once

#include <functional>
#include <memory>

namespace spikeloop::status {

/// True after SIGUSR1 or request_stop(). The loop of Process::run() looks at it every tick.
bool stop_requested();
void request_stop();

/// Whether whoever started us has this signal ignored, as nohup does with SIGHUP. A blocked one
/// waits for us all the same.
bool is_ignored(int number);

/// Something to do before the process dies of SIGTERM, in a thread of its own while the main thread
/// may be anywhere: flush a file, stop a robot. Hooks run newest first.
class TerminationHook {
 public:
  explicit TerminationHook(std::function<void()> action);
  /// Afterwards the action does not run any more.
  ~TerminationHook();
  TerminationHook(const TerminationHook&) = delete;
  TerminationHook& operator=(const TerminationHook&) = delete;

 private:
  std::function<void()> action_;
};

/// Blocks these signals in the calling thread, and so in all threads started later, and waits for
/// them in a thread of its own until it is destroyed. music_main() has one.
class SignalThread {
 public:
  SignalThread();
  ~SignalThread();
  SignalThread(const SignalThread&) = delete;
  SignalThread& operator=(const SignalThread&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::status
