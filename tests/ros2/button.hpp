// What an emergency button does, whichever DDS it is on.
#pragma once

#include <signal.h>

#include <chrono>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

namespace spikeloop::test {

/// To be called before the program has threads.
inline sigset_t block_button_signals() {
  sigset_t signals;
  ::sigemptyset(&signals);
  ::sigaddset(&signals, SIGTERM);
  ::sigaddset(&signals, SIGUSR1);
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

/// `once`: one message when somebody subscribes, and the end, as `ros2 topic pub --once`; `once2`:
/// when two subscribe (`-w 2`). `stay`: one at each SIGUSR1, until SIGTERM.
inline void run_button(const std::string& mode, const sigset_t& signals,
                       const std::function<int()>& subscribers,
                       const std::function<void()>& press) {
  constexpr std::chrono::milliseconds kPeriod{100};  // of that command, too
  if (mode == "once" || mode == "once2") {
    while (subscribers() < (mode == "once" ? 1 : 2)) {
      std::this_thread::sleep_for(kPeriod);
    }
    press();
    std::this_thread::sleep_for(kPeriod);
    return;
  }
  if (mode != "stay") {
    throw std::runtime_error("write once, once2 or stay, not '" + mode + "'");
  }
  std::puts("ready");
  std::fflush(stdout);
  for (int signal = 0; ::sigwait(&signals, &signal) == 0 && signal == SIGUSR1;) {
    press();
  }
}

}  // namespace spikeloop::test
