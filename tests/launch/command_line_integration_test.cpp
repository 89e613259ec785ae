// What `spikeloop` says to whoever types it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/launch/launcher.hpp"

namespace spikeloop::test {
namespace {

using testing::HasSubstr;

Outcome type(const std::vector<std::string>& arguments) {
  return run(launcher(arguments));
}

TEST(CommandLine, TellsItsVersion) {
  const Outcome outcome = type({"--version"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out, "spikeloop " SPIKELOOP_VERSION "\n");
}

TEST(CommandLine, HelpHasExamplesAndExitCodes) {
  const Outcome outcome = type({"run", "--help"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("spikeloop run braitenberg.music --roscore --robot"));
  EXPECT_THAT(outcome.out, HasSubstr("Exit codes:"));
  EXPECT_EQ(type({}).exit_code, 0);
  EXPECT_THAT(type({}).out, HasSubstr("run"));
}

TEST(CommandLine, SuggestsACommand) {
  const Outcome outcome = type({"rnu", "x.music"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err, "spikeloop: unknown command 'rnu'; did you mean 'run'?\n");
  EXPECT_EQ(type({"loop.music"}).err,
            "spikeloop: 'loop.music' is a file, not a command; write: spikeloop run loop.music\n");
}

TEST(CommandLine, SuggestsAnOption) {
  EXPECT_EQ(type({"run", "x.music", "--duratoin=3"}).err,
            "spikeloop: unknown option '--duratoin'; did you mean '--duration'?\n");
  EXPECT_EQ(type({"run", "x.music", "--duratoin=3"}).exit_code, 2);
  EXPECT_EQ(type({"run", "x.music", "--zzzzzzzzzzz"}).err,
            "spikeloop: unknown option '--zzzzzzzzzzz'; see spikeloop run --help\n");
  EXPECT_EQ(type({"run", "x.music", "y.music"}).err,
            "spikeloop: unexpected argument 'y.music'; see spikeloop run --help\n");
}

TEST(CommandLine, SaysWhatAnOptionNeeds) {
  EXPECT_EQ(type({"run", "x.music", "--record"}).err,
            "spikeloop: --record requires --out; see spikeloop run --help\n");
  EXPECT_EQ(type({"run"}).err, "spikeloop: FILE is required; see spikeloop run --help\n");
  EXPECT_THAT(type({"run", "x.music", "--duration", "-1"}).err, HasSubstr("--duration"));
}

TEST(CommandLine, AFileThatIsNotThere) {
  const Outcome outcome = type({"run", "/nowhere/x.music"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("'/nowhere/x.music': No such file or directory"));
}

TEST(CommandLine, ARunFolderThatCannotBeMade) {
  const TwoPrograms job;
  const Outcome outcome = type({"run", job.file(), "--out", "/proc/none"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_EQ(outcome.err,
            "spikeloop: cannot make the folder '/proc/none': No such file or directory\n");
}

TEST(CommandLine, AFileThatMusicWouldHangOn) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("x.music", "[a]\nnp=1\nbinary=sh\na.out -> c.in\n");
  const Outcome outcome = type({"run", file});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("x.music:4"));
}

TEST(CommandLine, ADryRunPrintsTheFileAndTheCommand) {
  const TwoPrograms job;
  const Outcome outcome = run(job.command({"--dry-run", "--duration", "3"}));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("# mpirun -np 2 --oversubscribe --bind-to none"));
  EXPECT_THAT(outcome.out, HasSubstr(" music " + job.folder() + "/effective.music\n"));
  EXPECT_THAT(outcome.out, HasSubstr("stoptime=3\n"));
  EXPECT_FALSE(std::filesystem::exists(job.folder()));
}

}  // namespace
}  // namespace spikeloop::test
