// What `spikeloop export` writes can be run by others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <sstream>

#include "tests/launch/launcher.hpp"

namespace spikeloop::test {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

/// A line that `export` printed, in a shell that finds the programs.
Outcome run_line(const std::string& line, const std::string& directory) {
  Command command = launcher({});
  command.arguments = {"sh", "-c", line};
  command.directory = directory;
  if (geteuid() == 0) {
    command.environment["OMPI_ALLOW_RUN_AS_ROOT"] = "1";
    command.environment["OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"] = "1";
  }
  return run(command);
}

TEST(Export, MpirunsLineRunsTheJob) {
  const TwoPrograms job;
  const std::string folder = (job.directory().path() / "job").string();
  const Outcome exported = run(launcher({"export", job.file(), "--out", folder}));
  ASSERT_EQ(exported.exit_code, 0) << exported.text();
  EXPECT_THAT(exported.out, StartsWith("mpirun --wdir "));
  const Outcome outcome = run_line(exported.out, "/");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_THAT(outcome.out, HasSubstr("first tick"));
}

/// There is no Slurm here; mpirun starts the same programs with the same arguments.
TEST(Export, EachProgramOfTheListForSrunFindsItsSection) {
  const TwoPrograms job;
  const std::string folder = (job.directory().path() / "job").string();
  const Outcome exported = run(launcher({"export", job.file(), "--out", folder, "--srun"}));
  ASSERT_EQ(exported.exit_code, 0) << exported.text();
  EXPECT_THAT(exported.out, HasSubstr("--multi-prog " + folder + "/programs.conf"));
  std::istringstream list(job.directory().read("job/programs.conf"));
  std::string line;
  std::string mpirun = "mpirun --oversubscribe --bind-to none --mca mpi_yield_when_idle 1";
  for (int programs = 0; std::getline(list, line);) {
    if (!line.starts_with('#')) {
      mpirun += (programs++ == 0 ? " -np 1 " : " : -np 1 ") + line.substr(line.find("  "));
    }
  }
  const Outcome outcome = run_line(mpirun, job.directory().path().string());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_THAT(outcome.out, HasSubstr("first tick"));
}

TEST(Export, WithoutAFolderPrintsAllThereIs) {
  const TwoPrograms job;
  const Outcome exported = run(launcher({"export", job.file()}));
  EXPECT_EQ(exported.exit_code, 0);
  EXPECT_THAT(exported.out, StartsWith("# mpirun -np 2 "));
  EXPECT_THAT(exported.out, HasSubstr("\n[b]\n"));
  EXPECT_EQ(run(launcher({"export", job.file(), "--srun"})).err,
            "spikeloop: --srun needs a folder for the list of programs; give one with --out, as in "
            "--out job\n");
}

TEST(Run, TakesAFileOfHosts) {
  const TwoPrograms job;
  const std::string hosts = job.directory().write("hosts", "localhost slots=4\n");
  const Outcome outcome = run(job.command({"--hostfile", hosts}));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_THAT(outcome.out, HasSubstr("a: first tick\n"));
  EXPECT_EQ(run(launcher({"run", job.file(), "--hostfile", hosts})).err,
            "spikeloop: --hostfile requires --out; see spikeloop run --help\n");
}

TEST(Run, AHostThatCannotBeReached) {
  const TwoPrograms job;
  const std::string hosts = job.directory().write("hosts", "nosuchhost.invalid slots=4\n");
  const Outcome outcome = run(job.command({"--hostfile", hosts}));
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(last_line(outcome.err), HasSubstr("a host of the job cannot be reached; ssh: "));
  EXPECT_THAT(last_line(outcome.err), EndsWith("/mpirun.log"));
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST(Export, PassesOnOnlyVariablesThatAreSet) {
  const TwoPrograms job;
  const std::string hosts = job.directory().write("hosts", "robot slots=4\n");
  Command command = launcher({"export", job.file(), "--hostfile", hosts});
  command.environment = {{"ROS_MASTER_URI", "http://robot:11311"},
                         {"ROS_DOMAIN_ID", ""},
                         {"ROS_LOCALHOST_ONLY", ""},
                         {"ROS_DISTRO", ""}};
  EXPECT_THAT(run(command).out, HasSubstr(" -x PATH -x ROS_MASTER_URI --tag-output"));
  command.environment["ROS_MASTER_URI"] = "";
  command.environment["ROS_DOMAIN_ID"] = "7";
  command.environment["ROS_STATIC_PEERS"] = "robot.local";
  EXPECT_THAT(run(command).out,
              HasSubstr(" -x PATH -x ROS_DOMAIN_ID -x ROS_STATIC_PEERS --tag-output"));
}

TEST(Export, PreloadsWhatLetsWaitingProgramsSleepBehindTheUsersLibraries) {
  const TwoPrograms job;
  Command command = launcher({"export", job.file()});
  command.environment = {{"LD_PRELOAD", "libc.so.6"}};
  EXPECT_THAT(
      run(command).out,
      testing::ContainsRegex(
          " -x LD_PRELOAD=libc.so.6:[^ ]*/lib/spikeloop/libspikeloop_waiting.so --tag-output"));
}

}  // namespace
}  // namespace spikeloop::test
