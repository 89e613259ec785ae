// Signals of a MUSIC program. SIGUSR1, which mpirun forwards: run the stop hooks, leave the loop,
// finalize, exit 0. SIGTERM, or the end of mpirun: run the termination hooks, then _exit(143) at
// once, because MUSIC does not come to an end in the second that mpirun leaves. Hooks that take
// longer than 3 s end the process with 143, too.
#pragma once

#include <functional>
#include <memory>
#include <utility>

namespace spikeloop::status {

/// True after SIGUSR1. The loop of Process::run() looks at it every tick.
bool stop_requested();

/// Whether whoever started us has this signal ignored, as nohup does with SIGHUP. A blocked one
/// waits for us all the same.
bool is_ignored(int number);

/// Something to do when a signal comes, in a thread of its own while the main thread may be
/// anywhere. Hooks run newest first.
class SignalHook {
 public:
  ~SignalHook();  ///< afterwards the action does not run any more
  SignalHook(const SignalHook&) = delete;
  SignalHook& operator=(const SignalHook&) = delete;

 protected:
  SignalHook(bool terminates, std::function<void()> action);

 private:
  friend class SignalThread;
  static void run_all(bool terminates);

  bool terminates_;
  std::function<void()> action_;
};

/// At SIGUSR1: stop a robot. The loop may still wait for other processes, which end one by one.
class StopHook : public SignalHook {
 public:
  explicit StopHook(std::function<void()> action) : SignalHook(false, std::move(action)) {}
};

/// Before the process dies of SIGTERM: flush a file, stop a robot.
class TerminationHook : public SignalHook {
 public:
  explicit TerminationHook(std::function<void()> action) : SignalHook(true, std::move(action)) {}
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
