// What the launcher makes of the news of a job.
#include "job_state.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <limits>
#include <string>

namespace spikeloop::launch {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

class State : public testing::Test {
 protected:
  MusicFile file_ = parse_music(
      "stoptime=10\n[a]\nnp=1\nbinary=rate_encoder\nclock_master=true\n[b]\nnp=1\nbinary=brain.py\n"
      "[c]\nnp=1\nbinary=linear_readout_decoder\na.out -> b.in\nb.out -> c.in\n",
      "job.music");
  JobState state_{file_};
  Clock::time_point now_ = Clock::now();

  /// Whether it is new progress.
  bool tell(const std::string& label, const std::string& type, json more = json::object()) {
    more["type"] = type;
    more["process"] = label;
    return state_.take(more, now_);
  }
  void beat(const std::string& label, const char* phase, double simulated_s) {
    tell(label, "alive", {{"phase", phase}, {"simulated_s", simulated_s}});
  }
  /// All three run, at 1 s of simulated time.
  void run() {
    for (const char* label : {"a", "b", "c"}) {
      tell(label, "first_tick");
      beat(label, "computing", 1.0);
    }
  }
  void line(std::optional<int> rank, const std::string& text, bool error = true) {
    state_.take(OutputLine{rank, error, text});
  }
};

TEST_F(State, ExpectsNewsOfOurProgramsAndOfThoseThatGaveSome) {
  tell("a", "started");
  EXPECT_EQ(
      state_.what_is_late(),
      "not started: 'c' (linear_readout_decoder); started, but still without a first tick: 'a' "
      "(rate_encoder); no news of: 'b' (brain.py)");
  tell("a", "started", {{"pid", 4321}});
  tell("b", "started");
  EXPECT_EQ(state_.what_is_late(),
            "not started: 'c' (linear_readout_decoder); started, but still without a first tick: "
            "'a' (rate_encoder), 'b' (brain.py)");
  tell("robot", "first_tick");
  EXPECT_FALSE(state_.any_ticked()) << "the robot is not of the file";
  tell("a", "first_tick");
  EXPECT_TRUE(state_.any_ticked());
  tell("b", "progress");
  tell("c", "report");
  EXPECT_EQ(state_.what_is_late(), "");
  EXPECT_EQ(state_.pids(), std::vector<pid_t>{4321});
}

TEST_F(State, NobodyIsLateWhileTheFirstWaitsForARobot) {
  for (const char* label : {"a", "b", "c"}) {
    tell(label, "started");
  }
  tell("a", "first_tick");
  beat("b", "exchanging", 0);
  beat("c", "exchanging", 0);
  beat("a", "meeting", 0);
  EXPECT_NE(state_.what_is_late(now_), "");
  beat("a", "waiting", 0);
  EXPECT_EQ(state_.what_is_late(now_), "");
  EXPECT_NE(state_.what_is_late(now_ + 4s), "") << "it has been silent since";
  beat("a", "waiting", 0.001);
  EXPECT_EQ(state_.what_is_late(now_),
            "waiting for the others: 'b' (brain.py), 'c' (linear_readout_decoder)");
}

TEST_F(State, AScriptIsNamedByItsFile) {
  const MusicFile file =
      parse_music("[a]\nnp=1\nbinary=spikeloop-script\nscript=models/brain.py\n", "job.music");
  EXPECT_EQ(JobState(file).summary()["processes"]["a"]["program"], "brain.py");
}

TEST_F(State, SaysWhyNobodyStarts) {
  EXPECT_EQ(state_.why_nobody_starts({}), "mpirun has not started any program");
  EXPECT_EQ(state_.why_nobody_starts({{"a", false}, {"c", true}}),
            "'b' (brain.py) has ended without MUSIC's Setup, where the others wait for it");
  EXPECT_EQ(state_.why_nobody_starts({{"a", true}, {"b", false}, {"c", false}}),
            "'a' (rate_encoder) has been stopped (SIGSTOP), and the others wait for it");
  EXPECT_EQ(state_.why_nobody_starts({{"a", false}, {"b", false}, {"c", false}}),
            "our programs wait in MUSIC's Setup, which these may not have called: 'b' (brain.py)");
}

TEST_F(State, AScriptMayHangBeforeItsHost) {
  const MusicFile file = parse_music(
      "[a]\nnp=1\nbinary=spikeloop-script\nscript=models/brain.py\n[b]\nnp=1\n"
      "binary=rate_encoder\n",
      "job.music");
  EXPECT_EQ(JobState(file).why_nobody_starts({{"a", false}, {"b", false}}),
            "programs wait in MUSIC's Setup, which these scripts call when they come to the host "
            "(spikeloop.music and its like): 'a' (brain.py)");
}

TEST_F(State, SaysWhomEverybodyWaitsFor) {
  tell("a", "started");
  beat("a", "meeting", 0);
  tell("c", "started");
  beat("c", "preparing", 0);
  EXPECT_EQ(state_.who_prepares(now_), "'c' (linear_readout_decoder)");
  EXPECT_EQ(state_.what_is_late(now_),
            "still preparing: 'c' (linear_readout_decoder); waiting for the others: 'a' "
            "(rate_encoder); no news of: 'b' (brain.py)");
  now_ += 4s;
  beat("a", "meeting", 0);
  EXPECT_EQ(state_.who_prepares(now_), "");
  EXPECT_EQ(state_.what_is_late(now_),
            "silent: 'c' (linear_readout_decoder); waiting for the others: 'a' (rate_encoder); no "
            "news of: 'b' (brain.py)");
  line(1, "ValueError: no such synapse");
  EXPECT_EQ(state_.what_is_late(now_),
            "silent: 'c' (linear_readout_decoder); waiting for the others: 'a' (rate_encoder); no "
            "news of: 'b' (brain.py); its last line: ValueError: no such synapse");
}

TEST_F(State, AProgramThatDoesNotEndItsStepHoldsUpTheJob) {
  run();
  now_ += 9s;
  beat("a", "exchanging", 1.01);
  beat("b", "computing", 1.0);
  beat("c", "exchanging", 1.0);
  EXPECT_EQ(state_.who_stands_still(10s, now_), "");
  now_ += 2s;
  for (const char* label : {"a", "c"}) {
    beat(label, "exchanging", 1.0 + 0.01 * (*label == 'a'));
  }
  beat("b", "computing", 1.0);
  EXPECT_EQ(state_.who_stands_still(10s, now_),
            "at 1 s of simulated time: 'b' (brain.py) does not come to the end of its step");
}

TEST_F(State, AProgramThatIsSilentHoldsUpTheJob) {
  run();
  now_ += 11s;
  beat("a", "exchanging", 1.0);
  beat("b", "exchanging", 1.0);
  EXPECT_EQ(
      state_.who_stands_still(10s, now_),
      "at 1 s of simulated time: 'c' (linear_readout_decoder) neither ticks nor answers: it is "
      "stopped, or hangs");
}

TEST_F(State, WhoHoldsUpTheJobMayHaveMovedLaterThanTheOthers) {
  run();
  now_ += 6s;
  beat("c", "computing", 1.01);
  now_ += 5s;
  beat("a", "exchanging", 1.0);
  beat("b", "exchanging", 1.0);
  EXPECT_EQ(
      state_.who_stands_still(10s, now_),
      "at 1 s of simulated time: 'c' (linear_readout_decoder) neither ticks nor answers: it is "
      "stopped, or hangs");
}

TEST_F(State, AForeignProgramHoldsUpTheJob) {
  for (const char* label : {"a", "c"}) {
    tell(label, "first_tick");
  }
  now_ += 11s;
  beat("a", "exchanging", 0.0);
  beat("c", "exchanging", 0.0);
  EXPECT_EQ(state_.who_stands_still(10s, now_),
            "at 0 s of simulated time: our programs wait in MUSIC for 'b' (brain.py)");
  tell("b", "started");
  EXPECT_EQ(state_.who_stands_still(10s, now_),
            "at 0 s of simulated time: all programs wait for each other in MUSIC");
}

TEST_F(State, WhoWaitsForTheClockHoldsUpNobody) {
  run();
  now_ += 11s;
  beat("a", "waiting", 1.0);
  beat("b", "exchanging", 1.0);
  beat("c", "exchanging", 1.0);
  EXPECT_EQ(state_.who_stands_still(10s, now_), "") << "a tick is longer than 10 s";
  for (int i = 2; i < 5; ++i) {
    beat("a", "waiting", i);
    EXPECT_EQ(state_.who_stands_still(10s, now_), "");
    now_ += 4s;
  }
  for (const char* label : {"b", "c"}) {
    beat(label, "exchanging", 1.0);
  }
  beat("a", "waiting", 5.0);
  EXPECT_NE(state_.who_stands_still(10s, now_), "") << "the clock goes on, the others do not";
}

TEST_F(State, WhoHasJustCeasedToWaitMaySayWhy) {
  run();
  beat("a", "waiting", 1.0);
  now_ += 11s;
  beat("a", "computing", 1.0);
  beat("b", "exchanging", 1.0);
  beat("c", "exchanging", 1.0);
  EXPECT_EQ(state_.who_stands_still(10s, now_), "");
}

TEST_F(State, TheTimeForWhichOneWaitedDoesNotCountForTheOthers) {
  run();
  beat("a", "waiting", 1.0);
  now_ += 11s;
  EXPECT_FALSE(state_.one_waits(now_)) << "it is silent";
  beat("a", "waiting", 1.0);
  EXPECT_TRUE(state_.one_waits(now_));
  beat("a", "computing", 1.0);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(state_.who_stands_still(10s, now_), "") << i;
    now_ += 4s;
    for (const char* label : {"a", "b", "c"}) {
      beat(label, "exchanging", 1.0);
    }
  }
  EXPECT_NE(state_.who_stands_still(10s, now_), "");
}

TEST_F(State, AProgramThatEndsBeforeItsTimeIsNamed) {
  run();
  tell("a", "progress", {{"simulated_s", 9.9995}});
  tell("a", "report");
  beat("a", "computing", 9.99);  // of another thread, which was late
  EXPECT_EQ(state_.who_ended_early(), "");
  tell("c", "report");
  EXPECT_EQ(
      state_.who_ended_early(),
      "'c' (linear_readout_decoder) ended at 1 s of simulated time, before its stoptime of 10 s");
  const MusicFile endless = parse_music("[a]\nnp=1\nbinary=rate_encoder\n", "job.music");
  JobState state(endless);
  state.take({{"type", "progress"}, {"process", "a"}, {"simulated_s", 2.0}});
  state.take({{"type", "report"}, {"process", "a"}});
  EXPECT_EQ(state.who_ended_early(),
            "'a' (rate_encoder) ended at 2 s of simulated time, without being asked to");
}

TEST_F(State, AnyMessageIsTakenOrIgnored) {
  run();
  for (const json& value : {json(nullptr), json(-1), json(1e300), json("x"), json::array({1}),
                            json(std::numeric_limits<std::uint64_t>::max())}) {
    for (const char* type : {"started", "alive", "progress", "report", "failure", "leaving", "x"}) {
      json more;
      for (const char* key : {"pid", "phase", "simulated_s", "wall_s", "overruns", "counters",
                              "summary", "exit_code", "message", "rank"}) {
        more[key] = value;
      }
      tell("b", type, more);
      tell("b", type);
    }
  }
  for (int i = 0; i < 10'000; ++i) {
    tell(std::to_string(i), "first_tick");
  }
  EXPECT_TRUE(state_.has_ticked("0"));
  EXPECT_FALSE(state_.has_ticked("9999")) << "its messages would fill the memory";
}

TEST_F(State, ADeathThatMpirunDoesNotNotice) {
  tell("a", "started", {{"pid", 10}});
  tell("c", "started", {{"pid", 12}});
  std::map<pid_t, int> ended;
  const auto end_of = [&](pid_t pid) {
    const auto found = ended.find(pid);
    return found == ended.end() ? std::nullopt : std::optional(found->second);
  };
  EXPECT_FALSE(state_.first_death(end_of));
  ended[12] = SIGKILL;
  EXPECT_EQ(state_.first_death(end_of)->message,
            "'c' (linear_readout_decoder) was killed by signal 9 (Killed)");
  EXPECT_EQ(state_.first_death(end_of)->exit_code, 137);
  ended[12] = 7 << 8;
  EXPECT_EQ(state_.first_death(end_of)->message,
            "'c' (linear_readout_decoder) ended with exit code 7");
  ended[12] = -1;
  EXPECT_EQ(state_.first_death(end_of)->message,
            "'c' (linear_readout_decoder) has ended before its time");
  tell("c", "report");
  EXPECT_FALSE(state_.first_death(end_of)) << "it had done its work";
}

TEST_F(State, EverybodyHasReportedWhenThoseThatAreExpectedHave) {
  tell("a", "report");
  EXPECT_FALSE(state_.all_reported());
  tell("c", "report");
  EXPECT_TRUE(state_.all_reported());
  tell("b", "started");
  EXPECT_FALSE(state_.all_reported());
}

TEST_F(State, ProgressIsThatOfTheProcessThatWaitsForTheClock) {
  tell("c", "progress", {{"simulated_s", 1.0}, {"wall_s", 2.0}});
  EXPECT_EQ(state_.progress().simulated_s, 1.0);
  tell("a", "progress", {{"simulated_s", 3.0}, {"wall_s", 4.0}, {"overruns", 5}});
  tell("c", "progress", {{"simulated_s", 7.0}});
  tell("robot", "progress", {{"simulated_s", 9.0}});
  EXPECT_EQ(state_.progress().simulated_s, 3.0);
  EXPECT_EQ(state_.progress().overruns, 5u);
  EXPECT_EQ(state_.progress().real_time_factor(), 0.75);
  EXPECT_EQ(state_.progress().total_s, 10.0);
  EXPECT_FALSE(tell("c", "report", {{"simulated_s", 10.0}}));
  EXPECT_EQ(state_.progress().simulated_s, 3.0);
  EXPECT_TRUE(tell("a", "report", {{"simulated_s", 4.0}, {"wall_s", 8.0}, {"overruns", 6}}));
  EXPECT_EQ(state_.progress().simulated_s, 4.0) << "the message before it was lost";
  EXPECT_EQ(state_.progress().overruns, 6u);
  EXPECT_EQ(state_.progress().real_time_factor(), 0.5);
}

TEST_F(State, OverrunsAreThoseOfAllPartsOfTheJob) {
  const MusicFile file = parse_music(
      "np=1\nclock_master=true\n[a]\nbinary=rate_encoder\n[b]\nbinary=rate_encoder\n", "job.music");
  JobState state(file);
  const auto tell = [&](const char* label, double simulated_s, int overruns) {
    return state.take({{"type", "progress"},
                       {"process", label},
                       {"simulated_s", simulated_s},
                       {"overruns", overruns}},
                      now_);
  };
  EXPECT_TRUE(tell("a", 1.0, 2));
  EXPECT_TRUE(tell("b", 3.0, 4)) << "is shown";
  EXPECT_EQ(state.progress().overruns, 6u);
  EXPECT_TRUE(tell("b", 4.0, 5));
  EXPECT_FALSE(tell("b", 5.0, 5));
  EXPECT_TRUE(tell("a", 2.0, 3));
  EXPECT_EQ(state.progress().overruns, 8u);
  EXPECT_EQ(state.progress().simulated_s, 2.0) << "of the first section";
  EXPECT_FALSE(tell("b", 2.0, 4)) << "an older message that comes later";
  EXPECT_EQ(state.summary()["overruns"], 8);
}

TEST_F(State, MergesTheSummaries) {
  tell("a", "report", {{"summary", {{"spikes", 5}}}, {"counters", {{"late", 1}}}});
  tell("robot", "report", {{"summary", {{"collisions", 2}}}});
  tell("c", "report", {{"summary", "nonsense"}});
  json summary = state_.summary();
  EXPECT_EQ(summary["spikes"], 5);
  EXPECT_EQ(summary["collisions"], 2);
  EXPECT_EQ(summary["processes"]["a"]["counters"]["late"], 1);
  EXPECT_EQ(summary["processes"]["b"]["reported"], false);
  EXPECT_EQ(summary["file"], "job.music");
}

TEST_F(State, TheFirstFailureIsTheReason) {
  tell("c", "failure", {{"exit_code", 5}, {"message", "tau is 0"}});
  tell("a", "failure", {{"exit_code", 3}, {"message", "peer gone"}});
  line(0, "Error in MUSIC library: x");
  const Failure failure = state_.explain({1});
  EXPECT_EQ(failure.exit_code, 5);
  EXPECT_EQ(failure.message, "c: tau is 0");
}

TEST_F(State, WhatRunsInMpirunsPlaceIsNamed) {
  EXPECT_EQ(state_.explain({137, true, {}, "spikeloop-fused"}).message,
            "spikeloop-fused was killed by signal 9 (Killed)");
  EXPECT_EQ(state_.explain({1, false, {}, "spikeloop-fused"}).message,
            "spikeloop-fused ended with exit code 1");
}

TEST_F(State, AFailureWithoutWordsOrCodeIsOne) {
  tell("c", "failure", {{"exit_code", "five"}});
  EXPECT_EQ(state_.explain({0}).exit_code, 1);
  EXPECT_EQ(state_.explain({0}).message, "c: failed");
}

TEST_F(State, ThenMusicsError) {
  line(0, "Error in MUSIC library: too short latency (0.02 s) around loop: , ");
  line({}, "MPI_ABORT was invoked on rank 0 in communicator MPI_COMM_WORLD");
  line({}, "with errorcode 1.");
  EXPECT_EQ(state_.explain({1}).message,
            "Error in MUSIC library: too short latency (0.02 s) around loop: , ");
  EXPECT_EQ(state_.explain({1}).exit_code, 1);
}

TEST_F(State, ThenHowAProgramEnded) {
  line(1, "Traceback");
  line(1, "ImportError: no nest");
  line(1, "printed", false);
  line({}, "  Process name: [[16537,1],1]");
  line({}, "  Exit code:    2");
  EXPECT_EQ(state_.explain({2}).message,
            "'b' (brain.py) ended with exit code 2; its last line: ImportError: no nest");
}

TEST_F(State, WhoAbortsSaysSoItself) {
  const std::string place = "/lib/libmpi.so.40(ompi_mpi_abort+0x15f) [0x7f]";
  state_.take(OutputLine{{}, true, "[vm:10] [1] func:" + place, 1});
  line({}, "ORTE_ERROR_LOG: Out of resource in file show_help.c at line 501");
  EXPECT_EQ(state_.explain({9}).message, "'b' (brain.py) ended with exit code 9");
  EXPECT_EQ(state_.explain({9}).exit_code, 9);
}

TEST_F(State, ThenWhoWasEndedFirst) {
  tell("c", "terminated");
  tell("a", "terminated");
  EXPECT_EQ(state_.explain({1}).message, "mpirun ended with exit code 1")
      << "which was ended itself";
  EXPECT_EQ(state_.explain({143}).message,
            "'c' (linear_readout_decoder) was ended by signal 15 (Terminated)");
  EXPECT_EQ(state_.explain({143}).exit_code, 143);
}

TEST_F(State, ThenWhatMpirunSaidLast) {
  EXPECT_EQ(state_.explain({3}).message, "mpirun ended with exit code 3");
  line({}, "not enough slots");
  line({}, "-------------");
  EXPECT_EQ(state_.explain({3}).message,
            "mpirun ended with exit code 3; its last line: not enough slots");
  EXPECT_EQ(state_.explain({3}).exit_code, 3);
  line({}, "ssh: Could not resolve hostname robot: Name or service not known");
  line({}, "This usually is caused by:");
  EXPECT_EQ(state_.explain({255}).message,
            "a host of the job cannot be reached; ssh: Could not resolve hostname robot: Name or "
            "service not known");
  EXPECT_EQ(state_.explain({255}).exit_code, 3);
}

TEST_F(State, MpirunItselfMayBeKilled) {
  EXPECT_EQ(state_.explain({137, true}).message, "mpirun was killed by signal 9 (Killed)");
  EXPECT_EQ(state_.explain({137}).message, "mpirun ended with exit code 137");
  EXPECT_EQ(state_.explain({137, true}).exit_code, 137);
}

TEST_F(State, WhoWasMissedWhenMpirunNamesNobody) {
  EXPECT_EQ(state_.explain({129, false, {"b"}}).message,
            "'b' (brain.py) was killed by signal 1 (Hangup)");
  EXPECT_EQ(state_.explain({7, false, {"b"}}).message,
            "'b' (brain.py) ended before MUSIC's Setup, with exit code 7");
  EXPECT_EQ(state_.explain({129, true, {"b"}}).message, "mpirun was killed by signal 1 (Hangup)");
}

TEST_F(State, ARankThatNoSectionHasIsNamedByItsNumber) {
  line({}, "mpirun has exited due to process rank 9 with PID 0 on");
  EXPECT_EQ(state_.explain({1}).message, "rank 9 ended without MUSIC's finalize");
}

}  // namespace
}  // namespace spikeloop::launch
