// What `spikeloop` says to whoever types it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>

#include "tests/launch/launcher.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

using testing::HasSubstr;
using testing::Not;

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
  EXPECT_THAT(outcome.out,
              HasSubstr("  3  a program, the robot or the ROS master is missing, stalls or ends "
                        "too early\n"));
  EXPECT_THAT(outcome.out, HasSubstr("129, 130, 131, 138, 143  stopped by SIGHUP (a closed "
                                     "terminal), Ctrl-C, SIGQUIT, SIGUSR1, SIGTERM\n"));
  EXPECT_THAT(outcome.out, HasSubstr("--start-timeout TIME=60 "));
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
  const Outcome nowhere = type({"run", "x.music", "--record", "--out", ""});
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_EQ(
      nowhere.err,
      "spikeloop: --out: the name of the folder is empty; write one; see spikeloop run --help\n");
  EXPECT_EQ(
      type({"run", "x.music", "--hostfile", "", "--out", "o"}).err,
      "spikeloop: --hostfile: the name of the hostfile is empty; write one; see spikeloop run "
      "--help\n");
  EXPECT_EQ(type({"run"}).err, "spikeloop: FILE is required; see spikeloop run --help\n");
}

TEST(CommandLine, SaysWhichNumberAnOptionTakes) {
  const std::string duration = ": write the simulated seconds, above 0, as in --duration 60";
  const std::string factor =
      ": write simulated over wall time, from 0.001 to 1000, as in --real-time-factor 0.5";
  const std::string timeout = ": write the seconds to wait, above 0, as in --start-timeout 120";
  const std::string seed = ": write a whole number from 0 to 9223372036854775807, as in --seed 7";
  const std::vector<std::array<std::string, 3>> cases{
      {"--duration", "0", duration},
      {"--duration", "-1", duration},
      {"--duration", "inf", duration},
      {"--duration", "nan", duration},
      {"--duration", "1e-12", duration},
      {"--duration", "5m", duration},
      {"--duration", "1e12", ": write the simulated seconds, at most 1e9, as in --duration 60"},
      {"--real-time-factor", "nan", factor},
      {"--real-time-factor", "0", factor},
      {"--real-time-factor", "1e4", factor},
      {"--real-time-factor", "1s", factor},
      {"--start-timeout", "nan", timeout},
      {"--start-timeout", "0", timeout},
      {"--start-timeout", "1e7",
       ": write the seconds to wait, at most 1e6, as in --start-timeout 120"},
      {"--seed", "-1", seed},
      {"--seed", "99999999999999999999", seed},
      {"--seed", "9223372036854775808", seed},
      {"--seed", "1.5", seed}};
  for (const auto& [option, text, remedy] : cases) {
    const Outcome outcome = type({"run", "x.music", option, text});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.err, "spikeloop: " + option + " " + text + remedy + "\n");
  }
  EXPECT_EQ(type({"run", "x.music", "--duration", ""}).err,
            "spikeloop: --duration ''" + duration + "\n");
  EXPECT_EQ(type({"run", "x.music", "--duration", "5 parsecs"}).err,
            "spikeloop: --duration '5 parsecs'" + duration + "\n");
  for (const std::string port : {"99999", "-1"}) {
    EXPECT_EQ(type({"view", "runs", "--live-port", port}).err,
              "spikeloop: --live-port: Value " + port +
                  " not in range 0 to 65535; see spikeloop view --help\n");
  }
}

TEST(CommandLine, NumbersMayHaveUnits) {
  const TwoPrograms job;
  for (const auto& [text, seconds] :
       {std::pair{"5s", "5"}, {"1min", "60"}, {"500 ms", "0.5"}, {"1e9", "1000000000"}}) {
    const Outcome outcome =
        run(job.command({"--dry-run", "--duration", text, "--start-timeout", "2 min", "--seed",
                         "9223372036854775807", "--real-time-factor", "1e-3"}));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr(std::string("stoptime=") + seconds + "\n"));
    EXPECT_THAT(outcome.out, HasSubstr("\nseed=9223372036854775807\n"));
    EXPECT_THAT(outcome.out, HasSubstr("\nrtf=0.001\n"));
  }
}

TEST(CommandLine, AFileThatIsNotThere) {
  const Outcome outcome = type({"run", "/nowhere/x.music"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, Fault("... '/nowhere/x.music': ... [SL0109]\n"));
}

TEST(CommandLine, ARunFolderThatCannotBeMade) {
  const TwoPrograms job;
  const Outcome outcome = type({"run", job.file(), "--out", "/proc/none"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, Fault("spikeloop: cannot make the folder '/proc/none': ... [SL0109]\n"));
}

TEST(CommandLine, RunFolderThatIsADanglingLink) {
  const TwoPrograms job;
  const TemporaryDirectory directory;
  const std::string link = (directory.path() / "link").string();
  std::filesystem::create_symlink(directory.path() / "nothing", link);
  const Outcome outcome = type({"run", job.file(), "--out", link});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("'" + link + "': it is a symbolic link to nothing; remove"));
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

TEST(CommandLine, EarlierNamesGiveTheSameJob) {
  const TemporaryDirectory directory;
  const auto printed = [&](const std::string& option, const std::string& key,
                           const std::string& port) {
    const std::string file =
        directory.write("x.music",
                        "stoptime=1\n[command]\nnp=1\nbinary=ros_command_adapter\nros_topic=/out\n"
                        "message_type=FloatArray\n" +
                            key +
                            "=true\n[sensor]\nnp=1\nbinary=ros_sensor_adapter\nros_topic=/in\n"
                            "message_type=FloatArray\nsensor.out -> command.in [2]\n" +
                            port);
    const Outcome outcome = type({"run", file, "--dry-run", option});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  };
  const std::string connected =
      printed("--no-data-stamp", "clock_master", "sensor.data_stamp -> command.data_stamp [1]\n");
  EXPECT_THAT(connected, HasSubstr("\nsensor.data_stamp -> command.data_stamp [1]\n"));
  EXPECT_THAT(connected, HasSubstr("clock_master=true\n"));
  EXPECT_EQ(printed("--no-pace", "pace", "sensor.pace -> command.pace [1]\n"), connected);
  const std::string unconnected = printed("--no-data-stamp", "clock_master", "");
  EXPECT_THAT(unconnected, Not(HasSubstr("data_stamp")));
  EXPECT_EQ(printed("--no-pace", "pace", ""), unconnected);
  const std::string experiment = directory.write("x.yaml", "experiment: x\n");
  EXPECT_THAT(type({"run", experiment, "--no-pace"}).err,
              HasSubstr("--no-pace is for .music files"));
}

}  // namespace
}  // namespace spikeloop::test
