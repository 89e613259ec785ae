// mpirun and roscore that do not do what they should: scripts in their place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/processes/reserved_port.hpp"
#include "tests/launch/launcher.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

using testing::HasSubstr;

/// The job with this script found before the program of that name.
Outcome run_with(const TwoPrograms& job, const std::string& program, const std::string& script,
                 const std::vector<std::string>& more = {}) {
  const std::string path = job.directory().write(program, "#!/bin/sh\n" + script + "\n");
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  Command command = job.command(more);
  command.environment["PATH"] = job.directory().path().string() + ":" + getenv("PATH");
  command.environment["REAL_PATH"] = getenv("PATH");
  const ReservedPort nobody;
  command.environment["ROS_MASTER_URI"] = "http://127.0.0.1:" + nobody.text();
  return run(command);
}

TEST(Mpirun, ThatDoesNotStartTheJobIsTheReason) {
  const TwoPrograms job;
  const Outcome outcome = run_with(job, "mpirun", "echo 'no room for 2' >&2; exit 3");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(last_line(outcome.err), Fault("spikeloop: mpirun ... 3 ... no room for 2"));
}

TEST(Mpirun, ThatHangsWhenAllIsDoneIsEnded) {
  const TwoPrograms job;
  const Outcome outcome = run_with(
      job, "mpirun", "PATH=$REAL_PATH mpirun \"$@\"; trap '' TERM; while :; do sleep 1; done");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_THAT(outcome.err, HasSubstr("spikeloop: warning: mpirun has not ended 10 s after the last "
                                     "report: it is ended now\n"));
  EXPECT_EQ(outcome.left_behind, 0);
  EXPECT_EQ(job.summary()["exit_reason"], "finished");
}

TEST(OwnRosMaster, ThatEndsAtOnceIsTheReason) {
  const TwoPrograms job;
  const Outcome outcome = run_with(job, "rosmaster", "echo 'no port' >&2; exit 1", {"--roscore"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(last_line(outcome.err),
            "spikeloop: rosmaster ended before it answered; it says: no port [SL0701]");
}

// Its last line is where its traceback is.
TEST(OwnRosMaster, ThatGivesAReasonIsQuoted) {
  const TwoPrograms job;
  const Outcome outcome = run_with(job, "rosmaster",
                                   "echo 'RLException: Unable to contact my own server.' >&2\n"
                                   "echo 'The traceback is in the log file' >&2; exit 1",
                                   {"--roscore"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(last_line(outcome.err),
              Fault("spikeloop: ... it says: Unable to contact my own server ... [SL0701]"));
}

TEST(OwnRosMaster, ThatEndsWithoutAWordToo) {
  const TwoPrograms job;
  const Outcome outcome = run_with(job, "rosmaster", "", {"--roscore"});
  EXPECT_THAT(last_line(outcome.err),
              Fault("spikeloop: rosmaster ended before it answered [SL0701]"));
}

}  // namespace
}  // namespace spikeloop::test
