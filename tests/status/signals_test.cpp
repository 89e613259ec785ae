#include "spikeloop/status/signals.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include "spikeloop/status/deadline.hpp"

namespace spikeloop::status {
namespace {

// Runs `body` in a process of its own, as these change the process; its exit code, or -1.
template <typename Body>
int exit_code_of(Body body) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);
    body();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void wait_for_stop() {
  while (!stop_requested()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

TEST(Signals, UserSignal1AsksTheLoopToStop) {
  EXPECT_EQ(exit_code_of([] {
              const SignalThread thread;
              if (stop_requested()) {
                _exit(1);
              }
              kill(getpid(), SIGUSR1);
              wait_for_stop();
            }),
            0);
}

TEST(Signals, WhatReachesAnOlderThreadIsHeard) {
  EXPECT_EQ(exit_code_of([] {
              std::thread older([] { std::this_thread::sleep_for(std::chrono::seconds(10)); });
              const SignalThread thread;
              pthread_kill(older.native_handle(), SIGUSR1);
              wait_for_stop();
              pthread_kill(older.native_handle(), SIGTERM);
              std::this_thread::sleep_for(std::chrono::seconds(10));
            }),
            143);
}

TEST(Signals, UserSignal1RunsTheStopHooksAlone) {
  EXPECT_EQ(exit_code_of([] {
              const SignalThread thread;
              const TerminationHook termination([] { _exit(1); });
              const StopHook stop([] { _exit(stop_requested() ? 7 : 2); });
              kill(getpid(), SIGUSR1);
              std::this_thread::sleep_for(std::chrono::seconds(10));
            }),
            7);
}

TEST(Signals, TerminationRunsTheHooksNewestFirstAndExits143) {
  int pipe_ends[2];
  ASSERT_EQ(pipe(pipe_ends), 0);
  const auto say = [&](char letter) { EXPECT_EQ(write(pipe_ends[1], &letter, 1), 1); };
  EXPECT_EQ(exit_code_of([&] {
              const SignalThread thread;
              const TerminationHook first([&] { say('a'); });
              {
                const TerminationHook gone([&] { say('x'); });
              }
              const StopHook stop([&] { say('y'); });
              const TerminationHook failing([] { throw std::runtime_error("no"); });
              const TerminationHook last([&] { say('b'); });
              kill(getpid(), SIGTERM);
              std::this_thread::sleep_for(std::chrono::seconds(10));
            }),
            143);
  char said[8] = {};
  EXPECT_EQ(read(pipe_ends[0], said, sizeof said), 2);
  EXPECT_STREQ(said, "ba");
  close(pipe_ends[0]);
  close(pipe_ends[1]);
}

TEST(Signals, AHookThatHangsEndsTheProcess) {
  for (const int number : {SIGTERM, SIGUSR1}) {
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(exit_code_of([number] {
                const SignalThread thread;
                const auto hang = [] { std::this_thread::sleep_for(std::chrono::seconds(19)); };
                const TerminationHook termination(hang);
                const StopHook stop(hang);
                kill(getpid(), number);
                std::this_thread::sleep_for(std::chrono::seconds(19));
              }),
              143)
        << number;
    EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::seconds(3));
  }
}

TEST(Signals, AHookThatIsInTimeDoesNotEndTheProcess) {
  EXPECT_EQ(exit_code_of([] {
              const SignalThread thread;
              const StopHook stop([] {});
              kill(getpid(), SIGUSR1);
              wait_for_stop();
              std::this_thread::sleep_for(std::chrono::milliseconds(3500));
            }),
            0);
}

TEST(Deadline, AProcessWhoseDestructorsHangEndsWithItsExitCode) {
  EXPECT_EQ(exit_code_of([] {
              if (end_in_time(5) != 5) {
                _exit(1);
              }
              std::this_thread::sleep_for(std::chrono::seconds(19));
            }),
            5);
}

TEST(Signals, TheEndOfTheParentIsATermination) {
  int pipe_ends[2];
  ASSERT_EQ(pipe(pipe_ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    const pid_t child = fork();
    if (child == 0) {
      alarm(120);
      const SignalThread thread;
      const TerminationHook hook([&] {
        if (write(pipe_ends[1], "t", 1) != 1) {
          _exit(1);
        }
      });
      if (write(pipe_ends[1], "r", 1) != 1) {
        _exit(1);
      }
      std::this_thread::sleep_for(std::chrono::seconds(100));
      _exit(0);
    }
    std::this_thread::sleep_for(std::chrono::seconds(100));
    _exit(0);
  }
  close(pipe_ends[1]);  // when both processes have ended, read() returns 0
  char letter = 0;
  EXPECT_EQ(read(pipe_ends[0], &letter, 1), 1);
  EXPECT_EQ(letter, 'r');
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  EXPECT_EQ(read(pipe_ends[0], &letter, 1), 1);
  EXPECT_EQ(letter, 't');
  close(pipe_ends[0]);
}

TEST(Signals, AHangupWhileTheParentLivesIsNone) {
  EXPECT_EQ(exit_code_of([] {
              const SignalThread thread;
              kill(getpid(), SIGHUP);
              std::this_thread::sleep_for(std::chrono::milliseconds(100));
              kill(getpid(), SIGUSR1);
              wait_for_stop();
            }),
            0);
}

}  // namespace
}  // namespace spikeloop::status
