// A subreaper between us and a program: what it starts, reports and ends.
#include "spikeloop/processes/process_tree.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include "spikeloop/core/error.hpp"
#include "spikeloop/processes/descendants.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::launch {
namespace {

using test::Fault;

/// Everything it prints until it has gone.
std::string output_of(ProcessTree& tree) {
  std::string text;
  char buffer[4096];
  bool gone = false;
  while (!gone) {
    pollfd file{tree.fd(), POLLIN, 0};
    poll(&file, 1, 1000);
    gone = tree.gone();
    for (auto size = read(tree.out(), buffer, sizeof buffer); size > 0;
         size = read(tree.out(), buffer, sizeof buffer)) {
      text.append(buffer, static_cast<std::size_t>(size));
    }
  }
  return text;
}

ProgramStart shell(const std::string& script) {
  ProgramStart start;
  start.arguments = {"sh", "-c", script};
  return start;
}

TEST(ProcessTree, RunsAProgramWithItsEnvironmentInItsDirectory) {
  const test::TemporaryDirectory directory;
  ProgramStart start = shell("echo $GREETING; pwd; echo oops >&2; exit 7");
  start.environment["GREETING"] = "hello";
  start.directory = directory.path().string();
  ProcessTree tree(start);
  EXPECT_EQ(output_of(tree), "hello\n" + start.directory + "\n");
  EXPECT_EQ(exit_code(tree.status().value()), 7);
}

pid_t subreaper_of(const ProcessTree& tree) {
  std::ifstream status(fmt::format("/proc/{}/status", tree.pid()));
  pid_t subreaper = 0;
  for (std::string word; subreaper == 0 && status >> word;) {
    if (word == "PPid:") {
      status >> subreaper;
    }
  }
  return subreaper;
}

TEST(ProcessTree, WaitsForAProgramWhoseSubreaperWasKilled) {
  const test::TemporaryDirectory directory;
  // As mpirun, it needs its time to end; what it writes must not come after gone().
  ProcessTree tree(
      shell(fmt::format("trap 'sleep 0.5; echo > {}/late; exit 0' TERM; echo up; "
                        "while :; do sleep 0.05; done",
                        directory.path().string())));
  pollfd file{tree.out(), POLLIN, 0};
  poll(&file, 1, 10'000);
  const pid_t subreaper = subreaper_of(tree);
  ASSERT_GT(subreaper, 1);
  kill(subreaper, SIGKILL);
  EXPECT_EQ(output_of(tree), "up\n");
  EXPECT_TRUE(std::filesystem::exists(directory.path() / "late"));
  EXPECT_EQ(exit_code(tree.status().value()), 128 + SIGTERM);
}

TEST(ProcessTree, KillsAProgramWithoutSubreaperThatDoesNotEnd) {
  ProcessTree tree(shell("trap '' TERM; echo up; while :; do sleep 0.05; done"));
  pollfd file{tree.out(), POLLIN, 0};
  poll(&file, 1, 10'000);
  kill(subreaper_of(tree), SIGKILL);
  EXPECT_EQ(output_of(tree), "up\n") << "it has gone";
}

TEST(ProcessTree, EndsThoughItsSubreaperWasStopped) {
  ProcessTree tree(shell("sleep 100"));
  const pid_t subreaper = subreaper_of(tree);
  ASSERT_GT(subreaper, 1);
  kill(subreaper, SIGSTOP);
  tree.end();
  EXPECT_EQ(output_of(tree), "");
  EXPECT_EQ(exit_code(tree.status().value()), 128 + SIGTERM);
}

TEST(ProcessTree, SaysWhyAProgramCannotBeStarted) {
  ProgramStart start;
  start.arguments = {"/nowhere/tool"};
  try {
    ProcessTree tree(start);
    ADD_FAILURE();
  } catch (const TransportError& error) {
    EXPECT_THAT(error.what(), Fault("cannot start '/nowhere/tool': ... [SL0603]"));
  }
}

TEST(ProcessTree, TellsTheSignalThatEndedIt) {
  ProcessTree tree(shell("kill -SEGV $$"));
  output_of(tree);
  EXPECT_EQ(exit_code(tree.status().value()), 128 + SIGSEGV);
}

TEST(ProcessTree, EndsWhatTheProgramLeavesBehind) {
  // A session of its own, an orphan, deaf to SIGTERM: the subreaper adopts and kills it. The
  // program ends when the orphan has printed its number and writes to the program's own output
  // again.
  ProcessTree tree(
      shell("exec 3>&1; echo $(setsid sh -c 'trap \"\" TERM; echo $$; exec >&3; "
            "sleep 1000; sleep 1000' &)"));
  const pid_t orphan = std::stoi(output_of(tree));
  EXPECT_EQ(exit_code(tree.status().value()), 0);
  EXPECT_EQ(kill(orphan, 0), -1);
}

TEST(ProcessTree, EndAsksBeforeItKills) {
  ProcessTree tree(shell("trap 'echo bye; exit 0' TERM; echo up; while :; do sleep 0.05; done"));
  pollfd file{tree.out(), POLLIN, 0};
  poll(&file, 1, 10'000);
  tree.end();
  EXPECT_EQ(output_of(tree), "up\nbye\n");
}

TEST(ProcessTree, KillDoesNotWait) {
  ProcessTree tree(shell("trap '' TERM; echo up; while :; do sleep 0.05; done"));
  pollfd file{tree.out(), POLLIN, 0};
  poll(&file, 1, 10'000);
  tree.kill();
  output_of(tree);
  EXPECT_EQ(exit_code(tree.status().value()), 128 + SIGKILL);
}

TEST(ProcessTree, ItsEndIsTheProgramsEnd) {
  pid_t program = -1;
  {
    ProcessTree tree(shell("trap '' TERM; while :; do sleep 0.05; done"));
    program = tree.pid();
    EXPECT_EQ(kill(program, 0), 0);
  }
  EXPECT_EQ(kill(program, 0), -1);
}

TEST(ProcessTree, PassesASignalOn) {
  ProcessTree tree(shell("trap 'echo one; exit 3' USR1; echo up; while :; do sleep 0.05; done"));
  pollfd file{tree.out(), POLLIN, 0};
  poll(&file, 1, 10'000);
  tree.signal(SIGUSR1);
  EXPECT_EQ(output_of(tree), "up\none\n");
  EXPECT_EQ(exit_code(tree.status().value()), 3);
}

TEST(Descendants, AreFoundOverGenerations) {
  ProcessTree tree(shell("sleep 1000 & sh -c 'sleep 1000; :' & echo up; wait"));
  pollfd file{tree.out(), POLLIN, 0};
  poll(&file, 1, 10'000);
  // The shell's own child may need a moment to start its sleep.
  for (int i = 0; i < 200 && descendants(tree.pid()).size() < 3; ++i) {
    usleep(10'000);
  }
  EXPECT_EQ(descendants(tree.pid()).size(), 3u);
  EXPECT_GE(descendants(getpid()).size(), 5u) << "subreaper, shell and its three";
}

TEST(IsStopped, TellsWhoWaitsForSigcont) {
  EXPECT_FALSE(is_stopped(getpid()));
  const pid_t child = fork();
  if (child == 0) {
    raise(SIGSTOP);
    _exit(0);
  }
  siginfo_t info{};
  waitid(P_PID, static_cast<id_t>(child), &info, WSTOPPED | WNOWAIT);
  EXPECT_TRUE(is_stopped(child));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_FALSE(is_stopped(child));
}

TEST(EndOf, ReadsWhatTheParentHasNotAskedFor) {
  EXPECT_EQ(end_of(getpid()), std::nullopt);
  const auto status_after = [](auto work) {
    const pid_t child = fork();
    if (child == 0) {
      work();
    }
    siginfo_t info{};
    waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT);  // it stays a zombie
    const auto status = end_of(child);
    waitpid(child, nullptr, 0);
    EXPECT_EQ(end_of(child), -1) << "it is gone";
    return status;
  };
  EXPECT_EQ(status_after([] { _exit(7); }), 7 << 8);
  EXPECT_EQ(status_after([] { raise(SIGKILL); }), SIGKILL);
}

}  // namespace
}  // namespace spikeloop::launch
