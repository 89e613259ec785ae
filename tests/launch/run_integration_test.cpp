// Jobs of real MUSIC programs under the real mpirun: how they end, and that nothing outlives them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <fstream>

#include "spikeloop/processes/descendants.hpp"
#include "spikeloop/processes/process_tree.hpp"
#include "tests/launch/launcher.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;
using testing::StartsWith;

TEST(Run, AJobThatEndsWell) {
  const TwoPrograms job;
  const Outcome outcome = run(job.command());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(outcome.left_behind, 0);
  EXPECT_THAT(outcome.out, HasSubstr("a: first tick\n"));
  EXPECT_THAT(outcome.out, HasSubstr("b: first tick\n"));
  EXPECT_THAT(outcome.err,
              MatchesRegex("spikeloop: 0\\.[0-4] of 0\\.5 s, 3 overruns\nspikeloop: .*"))
      << "the first line has no real-time factor";
  EXPECT_EQ(last_line(outcome.err),
            "spikeloop: finished: 0.5 of 0.5 s, real-time factor 0.50, 3 overruns");
  auto summary = job.summary();
  EXPECT_EQ(summary["exit_code"], 0);
  EXPECT_EQ(summary["exit_reason"], "finished");
  EXPECT_EQ(summary["file"], job.file());
  EXPECT_DOUBLE_EQ(summary["simulated_s"], 0.5);
  EXPECT_DOUBLE_EQ(summary["wall_s"], 1.0);
  EXPECT_DOUBLE_EQ(summary["real_time_factor"], 0.5);
  EXPECT_EQ(summary["overruns"], 3);
  EXPECT_EQ(summary["a_ticks"], 50);
  EXPECT_EQ(summary["b_ticks"], 50);
  EXPECT_EQ(summary["processes"]["b"]["counters"]["ticks"], 50);
  EXPECT_EQ(summary["processes"]["b"]["program"], "spikeloop-network");
  EXPECT_EQ(summary["processes"]["b"]["reported"], true);
}

TEST(Run, TheRunFolderHasTheFileThatWasRunAndTheLog) {
  const TwoPrograms job;
  const Outcome outcome = run(job.command({"--duration", "0.2", "--seed", "9", "--quiet"}));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(outcome.text(), "");
  const std::string effective = job.directory().read("run/effective.music");
  EXPECT_LT(effective.find("[b]"), effective.find("[a]"));
  EXPECT_THAT(effective, HasSubstr("stoptime=0.2"));
  EXPECT_THAT(effective, HasSubstr("seed=9"));
  EXPECT_THAT(job.directory().read("run/mpirun.log"), HasSubstr("a: first tick\n"));
  EXPECT_DOUBLE_EQ(job.summary()["simulated_s"], 0.2);
}

TEST(Run, QuietShowsWarnings) {
  const TwoPrograms job("", "behaviour=warn");
  const Outcome outcome = run(job.command({"--quiet"}));
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "b: warning: the weights are odd\n");
  EXPECT_EQ(outcome.out, "b: brain.py:3: UserWarning: no synapses\n");
}

TEST(Run, ASecondOneMayUseTheFolderWhenTheFirstHasEndedAndItsResultsMayGo) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000");
  Child first(job.command());
  ASSERT_TRUE(first.wait_for("b: first tick", 30s)) << first.output();
  const Outcome second = run(job.command());
  EXPECT_EQ(second.exit_code, 4);
  EXPECT_EQ(second.err, "spikeloop: another run that has not ended writes to the folder '" +
                            job.folder() +
                            "'; wait for its end, or give another folder with --out [SL0109]\n");
  first.signal(SIGINT);
  EXPECT_EQ(first.wait().exit_code, 130);
  EXPECT_EQ(job.summary()["exit_code"], 130);

  std::ofstream(job.folder() + "/a.h5") << "\x89HDF spikeloop_format";
  const Outcome refused = run(job.command());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.err, "spikeloop: the folder '" + job.folder() +
                             "' has the results of a run; write --force to replace them, or give "
                             "another folder with --out [SL0109]\n");
  Child third(job.command({"--force"}));
  ASSERT_TRUE(third.wait_for("b: first tick", 30s)) << third.output();
  EXPECT_FALSE(std::filesystem::exists(job.folder() + "/a.h5"));
  EXPECT_FALSE(std::filesystem::exists(job.folder() + "/summary.json"));
  third.signal(SIGKILL);
  third.wait();
  EXPECT_EQ(run(job.command({"--duration", "0.1"})).exit_code, 0) << "the dead hold no folder";
}

TEST(Run, WithoutAFolderNothingIsWrittenBesideTheFile) {
  const TwoPrograms job;
  const Outcome outcome = run(launcher({"run", job.file()}));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_FALSE(std::filesystem::exists(job.folder()));
}

TEST(Run, AProgramThatFailsSaysWhy) {
  const TwoPrograms job("", "behaviour=fail");
  const Outcome outcome = run(job.command());
  EXPECT_EQ(outcome.exit_code, 5);
  EXPECT_EQ(last_line(outcome.err),
            "spikeloop: b: weights.json: the weights are odd; write even ones");
  EXPECT_THAT(outcome.err, HasSubstr("b: the weights are odd\n"));
  EXPECT_EQ(outcome.left_behind, 0);
  EXPECT_EQ(job.summary()["exit_code"], 5);
  EXPECT_EQ(job.summary()["exit_reason"], "b: weights.json: the weights are odd; write even ones");
}

TEST(Run, AProgramThatIsKilledIsNamed) {
  const TwoPrograms job("", "behaviour=die");
  const Outcome outcome = run(job.command());
  EXPECT_EQ(outcome.exit_code, 128 + SIGKILL);
  EXPECT_EQ(last_line(outcome.err),
            "spikeloop: 'b' (spikeloop-network) was killed by signal 9 (Killed)");
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST(Run, ASupervisingProcessThatIsKilledIsNamed) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000");
  Child child(job.command());
  ASSERT_TRUE(child.wait_for("a: first tick", 30s)) << child.output();
  ASSERT_TRUE(child.wait_for("b: first tick", 30s)) << child.output();
  pid_t supervisor = 0;
  for (const pid_t process : descendants(child.pid())) {
    std::ifstream file("/proc/" + std::to_string(process) + "/comm");
    std::string name;
    supervisor = std::getline(file, name) && name == kSubreaperName ? process : supervisor;
  }
  ASSERT_GT(supervisor, 1);
  kill(supervisor, SIGKILL);
  const Outcome outcome = child.wait();
  EXPECT_EQ(outcome.exit_code, 128 + SIGKILL);
  EXPECT_EQ(last_line(outcome.err),
            "spikeloop: spikeloop-keep, which supervises the programs of the job, was killed by "
            "signal 9 (Killed)");
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST(Run, AForeignProgramThatExitsIsNamedWithItsLastLine) {
  const TwoPrograms job("", "silent=yes\nbehaviour=exit", "./foreign");
  const Outcome outcome = run(job.command());
  EXPECT_EQ(outcome.exit_code, 7);
  EXPECT_THAT(last_line(outcome.err),
              Fault("spikeloop: 'b' (foreign) ... 7 ... ValueError: no such synapse"));
}

TEST(Run, AProgramThatLeavesWithoutFinalizeIsAFailure) {
  const TwoPrograms job("", "silent=yes\nbehaviour=leave", "./foreign");
  const Outcome outcome = run(job.command());
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(last_line(outcome.err),
              StartsWith("spikeloop: 'b' (foreign) ended without MUSIC's finalize"));
}

TEST(Run, AForeignProgramThatEndsBeforeItsTimeIsNamed) {
  const TwoPrograms job("stoptime=100", "stoptime=100\nsilent=yes\nbehaviour=end_early\nwhen=late",
                        "./foreign");
  const Outcome outcome = run(job.command());
  EXPECT_EQ(outcome.exit_code, 3) << outcome.text();
  EXPECT_THAT(last_line(outcome.err),
              MatchesRegex("spikeloop: 'b' \\(foreign\\) ended before [1-9].* s of "
                           "simulated time, its stoptime is "
                           "100 s; simulate as long as that"));
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST(Run, AnErrorOfMusicIsTheReason) {
  const TwoPrograms job("input=yes\nbinary=./foreign",
                        "output=yes\naccept_latency=0\nb.out -> a.in [1]");
  const Outcome outcome = run(job.command());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(last_line(outcome.err),
              StartsWith("spikeloop: Error in MUSIC library: too short latency"));
  EXPECT_THAT(outcome.err, HasSubstr("spikeloop: warning: the cycle a -> b -> a lacks 2 ms"));
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST(Run, AJobThatDoesNotBeginIsEnded) {
  const TwoPrograms job("", "behaviour=never_tick");
  const Outcome outcome = run(job.command({"--start-timeout", "5"}));
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(last_line(outcome.err),
              Fault("spikeloop: ... 5 s; started ... 'b' (spikeloop-network) ... 'a' "
                    "(poisson_encoder). A program that does not call MPI_Barrier(MPI_COMM_WORLD) "
                    "between MUSIC's Setup and Runtime needs barrier=false in the file; one that "
                    "starts slowly needs a longer --start-timeout ... [SL0703]"));
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST(Run, AProgramThatDoesNotReportIsNamed) {
  const TwoPrograms job("", "silent=yes\nbehaviour=never_tick");
  const Outcome outcome = run(job.command({"--start-timeout", "5"}));
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err,
              HasSubstr("within 5 s; not started: 'b' (spikeloop-network); waiting for "
                        "the others: 'a' (poisson_encoder)."));
}

/// Waits until both programs tick, then sends the signals 0.3 s apart.
Outcome interrupted(const Command& command, const std::vector<int>& signals) {
  Child child(command);
  EXPECT_TRUE(child.wait_for("a: first tick", 30s)) << child.output();
  EXPECT_TRUE(child.wait_for("b: first tick", 30s)) << child.output();
  for (const int number : signals) {
    child.signal(number);
    std::this_thread::sleep_for(300ms);
  }
  return child.wait();
}

TEST(Run, CtrlCEndsTheLoops) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000");
  const Outcome outcome = interrupted(job.command(), {SIGINT});
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_EQ(last_line(outcome.err), "spikeloop: stopped by Ctrl-C");
  EXPECT_EQ(outcome.left_behind, 0);
  auto summary = job.summary();
  EXPECT_EQ(summary["processes"]["a"]["reported"], true) << "the programs finalized";
  EXPECT_EQ(summary["processes"]["b"]["reported"], true);
  EXPECT_EQ(summary["exit_code"], 130);
}

/// Nobody listens yet when the signal comes: not even mpirun.
TEST(Run, CtrlCAtTheStartLetsNobodyTick) {
  int rounds = 0;
  for (const auto delay : {2ms, 5ms, 10ms, 20ms, 40ms}) {
    const TwoPrograms job("stoptime=1000", "stoptime=1000");
    Child child(job.command());
    while (!std::filesystem::exists(job.folder() + "/mpirun.log")) {
      std::this_thread::sleep_for(1ms);
    }
    std::this_thread::sleep_for(delay);
    if (!child.output().empty()) {
      continue;  // the job was faster
    }
    ++rounds;
    child.signal(SIGINT);
    const Outcome outcome = child.wait();
    EXPECT_EQ(outcome.exit_code, 130);
    EXPECT_THAT(outcome.out, Not(HasSubstr("first tick"))) << delay.count() << " ms";
    EXPECT_EQ(last_line(outcome.err), "spikeloop: stopped by Ctrl-C");
    EXPECT_EQ(outcome.left_behind, 0);
    EXPECT_EQ(job.summary()["exit_code"], 130);
  }
  EXPECT_GT(rounds, 0);
}

TEST(Run, SigtermDoesTheSame) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000");
  const Outcome outcome = interrupted(job.command(), {SIGTERM});
  EXPECT_EQ(outcome.exit_code, 143);
  EXPECT_EQ(last_line(outcome.err), "spikeloop: stopped by signal 15 (Terminated)");
  EXPECT_EQ(job.summary()["processes"]["a"]["reported"], true);
}

TEST(Run, SigquitAndSigusr1DoTheSame) {
  for (const auto& [number, name] :
       {std::pair{SIGQUIT, "Quit"}, {SIGUSR1, "User defined signal 1"}}) {
    const TwoPrograms job("stoptime=1000", "stoptime=1000");
    const Outcome outcome = interrupted(job.command(), {number});
    EXPECT_EQ(outcome.exit_code, 128 + number);
    const std::string reason = "stopped by signal " + std::to_string(number) + " (" + name + ")";
    EXPECT_EQ(last_line(outcome.err), "spikeloop: " + reason);
    EXPECT_EQ(job.summary()["exit_reason"], reason);
    EXPECT_EQ(job.summary()["processes"]["a"]["reported"], true);
    EXPECT_EQ(outcome.left_behind, 0);
  }
}

TEST(Run, ASecondSigusr1IsPatient) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000\nbehaviour=slow_to_stop");
  const Outcome outcome = interrupted(job.command(), {SIGUSR1, SIGUSR1});
  EXPECT_EQ(outcome.exit_code, 138);
  EXPECT_EQ(job.summary()["processes"]["b"]["reported"], true) << "it was not killed";
}

TEST(Run, OutputThatNobodyReadsDoesNotEndIt) {
  for (const std::string what :
       {"2>&1 | head -1; exit ${PIPESTATUS[0]}", ">/dev/full 2>&1", ">&- 2>&-"}) {
    const TwoPrograms job;
    const Outcome outcome = run(job.in_shell(what));
    EXPECT_EQ(outcome.exit_code, 0) << what << "\n" << outcome.text();
    EXPECT_EQ(job.summary()["exit_reason"], "finished") << what;
    EXPECT_EQ(job.summary()["a_ticks"], 50) << what;
    EXPECT_THAT(job.directory().read("run/effective.music"), StartsWith("stoptime=0.5")) << what;
    EXPECT_THAT(job.directory().read("run/mpirun.log"), Not(HasSubstr("finished:"))) << what;
    EXPECT_EQ(outcome.left_behind, 0);
  }
}

TEST(Run, AFailureThatNobodyReadsKeepsItsExitCode) {
  EXPECT_EQ(run(TwoPrograms("", "behaviour=fail").in_shell(">/dev/full 2>&1")).exit_code, 5);
  EXPECT_EQ(run(TwoPrograms("", "", "nowhere").in_shell(">/dev/full 2>&1")).exit_code, 2);
  EXPECT_EQ(run(TwoPrograms().in_shell("--dry-run >/dev/full 2>&1")).exit_code, 4);
}

/// Waits, by the log, until both programs tick.
void wait_for_ticks(const TwoPrograms& job) {
  const auto end = std::chrono::steady_clock::now() + 30s;
  std::string log;
  while (log.find("a: first tick") == std::string::npos ||
         log.find("b: first tick") == std::string::npos) {
    ASSERT_LT(std::chrono::steady_clock::now(), end) << log;
    std::this_thread::sleep_for(5ms);
    std::ifstream file(job.folder() + "/mpirun.log");
    log.assign(std::istreambuf_iterator<char>(file), {});
  }
}

TEST(Run, AClosedTerminalStopsIt) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000");
  Command command = job.in_shell(">/dev/full 2>&1");
  command.arguments[2].insert(0, "exec ");
  Child child(command);
  wait_for_ticks(job);
  child.signal(SIGHUP);
  const Outcome outcome = child.wait();
  EXPECT_EQ(outcome.exit_code, 129);
  EXPECT_EQ(outcome.left_behind, 0);
  EXPECT_EQ(job.summary()["exit_reason"], "stopped by signal 1 (Hangup)");
  EXPECT_EQ(job.summary()["processes"]["a"]["reported"], true);
}

TEST(Run, NohupKeepsItRunning) {
  const TwoPrograms job("stoptime=1", "stoptime=1");
  Command command = job.command();
  command.arguments.insert(command.arguments.begin(), "nohup");
  Child child(command);
  wait_for_ticks(job);
  child.signal(SIGHUP);
  EXPECT_EQ(child.wait().exit_code, 0);
  EXPECT_EQ(job.summary()["exit_reason"], "finished");
}

TEST(Run, CtrlCEndsThoseThatDoNotListen) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000\nbehaviour=stubborn");
  const Outcome outcome = interrupted(job.command(), {SIGINT});
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST(Run, ASecondCtrlCKillsAtOnce) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000\nbehaviour=stubborn");
  const Outcome outcome = interrupted(job.command(), {SIGINT, SIGINT});
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_EQ(outcome.left_behind, 0);
}

// GNU timeout signals its child, and then the group that the child is in.
TEST(Run, CtrlCTwiceAtOnceIsOne) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000");
  Child child(job.command());
  ASSERT_TRUE(child.wait_for("a: first tick", 30s)) << child.output();
  ASSERT_TRUE(child.wait_for("b: first tick", 30s)) << child.output();
  child.signal(SIGINT);
  std::this_thread::sleep_for(10ms);
  child.signal(SIGINT);
  EXPECT_EQ(child.wait().exit_code, 130);
  auto summary = job.summary();
  EXPECT_EQ(summary["processes"]["a"]["reported"], true) << "the programs finalized";
  EXPECT_EQ(summary["processes"]["b"]["reported"], true);
}

TEST(Run, ForeignProgramsGetNoSignalTheyMayNotKnow) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000\nsilent=yes\nbehaviour=stubborn",
                        "./foreign");
  const Outcome outcome = interrupted(job.command(), {SIGINT});
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST(Run, NothingOutlivesALauncherThatIsKilled) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000\nbehaviour=stubborn");
  Child child(job.command());
  ASSERT_TRUE(child.wait_for("a: first tick", 30s)) << child.output();
  ASSERT_TRUE(child.wait_for("b: first tick", 30s)) << child.output();
  const std::string scratch = scratch_of(child);
  ASSERT_TRUE(std::filesystem::exists(scratch)) << scratch;
  child.signal(SIGKILL);
  const Outcome outcome = child.wait();
  EXPECT_EQ(outcome.exit_code, 128 + SIGKILL);
  EXPECT_EQ(outcome.left_behind, 0);
  // Whoever removes it waits for the last process of the job.
  for (int i = 0; i < 1000 && std::filesystem::exists(scratch); ++i) {
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_FALSE(std::filesystem::exists(scratch));
}

TEST(Run, LeavesNoSharedMemoryBehind) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000\nbehaviour=stubborn");
  Child child(job.command());
  ASSERT_TRUE(child.wait_for("b: first tick", 30s)) << child.output();
  const std::string scratch = scratch_of(child);
  ASSERT_TRUE(std::filesystem::exists(scratch)) << scratch;
  child.signal(SIGINT);
  std::this_thread::sleep_for(300ms);
  child.signal(SIGINT);
  child.wait();
  EXPECT_FALSE(std::filesystem::exists(scratch));
}

TEST(Run, AMissingProgramIsFoundBeforeAnythingStarts) {
  const TwoPrograms job("", "", "rate_encodre");
  const Outcome outcome = run(job.command());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(
      last_line(outcome.err),
      HasSubstr("/two.music:10:1: section 'b': there is no program 'rate_encodre' in PATH"));
}

/// As in a terminal held by Ctrl-S: the launcher's output is a pipe that is full.
TEST(Run, OutputThatIsHeldUpHoldsUpNothing) {
  const TwoPrograms job("stoptime=1000", "stoptime=1000");
  Command command = job.in_shell(">&3 2>&1");
  const std::string pipe = (job.directory().path() / "pipe").string();
  command.arguments[2].insert(
      0, "mkfifo '" + pipe + "'; exec 3<>'" + pipe + "'; head -c 65536 /dev/zero >&3; exec ");
  Child child(command);
  wait_for_ticks(job);
  child.signal(SIGINT);
  const std::string summary = job.folder() + "/summary.json";
  for (int i = 0; i < 100 && !std::filesystem::exists(summary); ++i) {
    std::this_thread::sleep_for(50ms);
  }
  auto ended = job.summary();
  EXPECT_EQ(ended["exit_code"], 130) << "stopped, though nobody could be told";
  EXPECT_EQ(ended["processes"]["a"]["reported"], true) << "it was not killed";
  EXPECT_EQ(ended["processes"]["b"]["reported"], true);
  child.signal(SIGKILL);  // it waits for its last words to be read
  EXPECT_EQ(child.wait().left_behind, 0);
}

}  // namespace
}  // namespace spikeloop::test
