// What the launcher makes of the news of a job.
#include "job_state.hpp"

#include <gtest/gtest.h>

namespace spikeloop::launch {
namespace {

using nlohmann::json;

class State : public testing::Test {
 protected:
  MusicFile file_ = parse_music(
      "stoptime=10\n[a]\nnp=1\nbinary=rate_encoder\npace=true\n[b]\nnp=1\nbinary=brain.py\n"
      "[c]\nnp=1\nbinary=linear_readout_decoder\na.out -> b.in\nb.out -> c.in\n",
      "job.music");
  JobState state_{file_};

  void tell(const std::string& label, const std::string& type, json more = json::object()) {
    more["type"] = type;
    more["process"] = label;
    state_.take(more);
  }
  void line(std::optional<int> rank, const std::string& text, bool error = true) {
    state_.take(OutputLine{rank, error, text});
  }
};

TEST_F(State, ExpectsNewsOfOurProgramsAndOfThoseThatGaveSome) {
  EXPECT_EQ(state_.what_is_late(), "not started: 'a' (rate_encoder), 'c' (linear_readout_decoder)");
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
  const Failure failure = state_.explain(1);
  EXPECT_EQ(failure.exit_code, 5);
  EXPECT_EQ(failure.message, "c: tau is 0");
}

TEST_F(State, AFailureWithoutWordsOrCodeIsOne) {
  tell("c", "failure", {{"exit_code", "five"}});
  EXPECT_EQ(state_.explain(0).exit_code, 1);
  EXPECT_EQ(state_.explain(0).message, "c: failed");
}

TEST_F(State, ThenMusicsError) {
  line(0, "Error in MUSIC library: too short latency (0.02 s) around loop: , ");
  line({}, "MPI_ABORT was invoked on rank 0 in communicator MPI_COMM_WORLD");
  line({}, "with errorcode 1.");
  EXPECT_EQ(state_.explain(1).message,
            "Error in MUSIC library: too short latency (0.02 s) around loop: , ");
  EXPECT_EQ(state_.explain(1).exit_code, 1);
}

TEST_F(State, ThenHowAProgramEnded) {
  line(1, "Traceback");
  line(1, "ImportError: no nest");
  line(1, "printed", false);
  line({}, "  Process name: [[16537,1],1]");
  line({}, "  Exit code:    2");
  EXPECT_EQ(state_.explain(2).message,
            "'b' (brain.py) ended with exit code 2; its last line: ImportError: no nest");
}

TEST_F(State, ThenWhatMpirunSaidLast) {
  EXPECT_EQ(state_.explain(3).message, "mpirun ended with exit code 3");
  line({}, "not enough slots");
  line({}, "-------------");
  EXPECT_EQ(state_.explain(3).message,
            "mpirun ended with exit code 3; its last line: not enough slots");
  EXPECT_EQ(state_.explain(3).exit_code, 3);
}

TEST_F(State, ARankThatNoSectionHasIsNamedByItsNumber) {
  line({}, "mpirun has exited due to process rank 9 with PID 0 on");
  EXPECT_EQ(state_.explain(1).message, "rank 9 ended without MUSIC's finalize");
}

}  // namespace
}  // namespace spikeloop::launch
