#include "tests/support/child.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_directory.hpp"

namespace spikeloop::test {
namespace {

using namespace std::chrono_literals;

TEST(Child, CapturesBothStreamsAndTheExitCode) {
  const auto outcome = run({{"sh", "-c", "echo one; echo two >&2; exit 7"}});
  EXPECT_EQ(outcome.out, "one\n");
  EXPECT_EQ(outcome.err, "two\n");
  EXPECT_EQ(outcome.exit_code, 7);
  EXPECT_FALSE(outcome.timed_out);
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST(Child, ReadsMoreThanAPipeHolds) {
  const auto outcome = run({{"sh", "-c", "head -c 1000000 /dev/zero | tr '\\0' x"}});
  EXPECT_EQ(outcome.out.size(), 1000000u);
}

TEST(Child, SaysOfASignalWhatAShellSays) {
  EXPECT_EQ(run({{"sh", "-c", "kill -9 $$"}}).exit_code, 137);
}

TEST(Child, KillsAtTheDeadlineWhateverRunsThen) {
  Command command{{"sh", "-c", "setsid sleep 1000 & trap '' TERM; sleep 1000"}};
  command.timeout = 300ms;
  Child child(command);
  const auto outcome = child.wait();
  EXPECT_TRUE(outcome.timed_out);
  EXPECT_TRUE(child.family().empty());
}

TEST(Child, KillsAndCountsWhatOutlivesIt) {
  Child child({{"sh", "-c", "setsid sleep 1000 >/dev/null 2>&1 & echo started"}});
  const auto outcome = child.wait();
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.left_behind, 1);
  EXPECT_TRUE(child.family().empty());
}

TEST(Child, GetsItsDirectoryAndEnvironment) {
  const TemporaryDirectory directory;
  Command command{{"sh", "-c", "pwd; echo $COLOUR"}};
  command.directory = directory.path();
  command.environment = {{"COLOUR", "green"}};
  EXPECT_EQ(run(command).out, directory.path().string() + "\ngreen\n");
}

TEST(Child, WaitsForWordsAndTakesSignals) {
  Child child(
      {{"sh", "-c", "trap 'echo caught; exit 3' USR1; echo ready; while :; do sleep 0.01; done"}});
  ASSERT_TRUE(child.wait_for("ready", 10s));
  EXPECT_FALSE(child.wait_for("never", 50ms));
  child.signal(SIGUSR1);
  const auto outcome = child.wait();
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_TRUE(outcome.says("caught"));
}

TEST(Child, SaysThatAProgramIsMissing) {
  const auto outcome = run({{"/no/such/program"}});
  EXPECT_EQ(outcome.exit_code, 127);
  EXPECT_TRUE(outcome.says("cannot start /no/such/program"));
}

}  // namespace
}  // namespace spikeloop::test
