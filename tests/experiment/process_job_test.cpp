// The job that a layout makes of an experiment: a section a process.
#include <gmock/gmock.h>

#include <algorithm>

#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/experiment/music_job.hpp"
#include "tests/experiment/experiment_text.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

using experiment::Connection;
using testing::HasSubstr;

constexpr const char* kHead = R"(experiment: cells
duration: 1 s
tick: 1 ms
sync: unpaced
nodes:
  a: {node: rate_encoder}
  b: {node: linear_readout}
  c: {node: sigmoid}
  one: {simulator: python, script: brain.py, gain: 3}
  two: {simulator: nest, script: brain.py}
connections:
  - c -> a [2]
  - b -> c [2, delay 1 tick]
)";

class ProcessJob : public testing::Test {
 protected:
  experiment::Experiment experiment(const std::string& connections) {
    files_ = std::make_unique<Files>(kHead + connections, std::map<std::string, std::string>{
                                                              {"brain.py", "import spikeloop\n"}});
    Read result = read(*files_, types_);
    EXPECT_THAT(result.faults, testing::IsEmpty());
    return result.experiment;
  }
  static MusicFile job_of(const experiment::Experiment& experiment) {
    return experiment::process_job(experiment::with_layout_delays(experiment), "out",
                                   {{"about", "{}"}})
        .file;
  }
  MusicFile job(const std::string& connections) { return job_of(experiment(connections)); }
  /// What is said of an experiment, or of connections, that cannot be.
  std::string refusal_of(const experiment::Experiment& experiment) {
    try {
      job_of(experiment);
    } catch (const ConfigurationError& error) {
      return files_->plain(error.what());
    }
    return "nothing";
  }
  std::string refusal(const std::string& connections) {
    return refusal_of(experiment(connections));
  }

  experiment::NodeTypes types_;
  std::unique_ptr<Files> files_;
};

TEST_F(ProcessJob, HasASectionASimulatorAndOneForTheOthers) {
  const MusicFile file = job("  - a -> one [2] -> two [2] -> b [2]\n");
  EXPECT_THAT(file.labels(), testing::ElementsAre("experiment", "one", "two"));
  EXPECT_NO_THROW(check_structure(file));
  EXPECT_THAT(to_text(file), HasSubstr("experiment.one__in -> one.in [2]\n"));
  EXPECT_THAT(to_text(file), HasSubstr("one.out -> two.in [2]\n"));
  EXPECT_THAT(to_text(file), HasSubstr("two.out -> experiment.two__out [2]\n"));
  EXPECT_EQ(key(file, "one", "binary"), "spikeloop-script");
  EXPECT_EQ(key(file, "one", "gain"), "3");
  EXPECT_EQ(key(file, "one", "barrier"), "false");
  EXPECT_EQ(key(file, "experiment", "about"), "{}");
}

// Between two simulators nobody knows what a connection carries.
TEST_F(ProcessJob, SaysWhatAScriptsPortsCarryAsFarAsItIsKnown) {
  const MusicFile file =
      job("  - a -> one [2] -> two [2] -> b [2]\n"
          "  - a -> one.more [2]\n"
          "  - c -> one.level [2]\n");
  EXPECT_EQ(key(file, "one", "spikes_in"), "in,more");
  EXPECT_EQ(key(file, "one", "signals_in"), "level");
  EXPECT_EQ(key(file, "one", "spikes_out"), "none");
  EXPECT_EQ(key(file, "one", "signals_out"), "none");
  EXPECT_EQ(key(file, "two", "spikes_in"), "none");
  EXPECT_EQ(key(file, "two", "spikes_out"), "out");
  EXPECT_EQ(key(file, "two", "signals_out"), "none");
}

// MUSIC wants acceptable latencies that add up to a tick a process around every cycle, and delays
// by whole ticks of them alone.
TEST_F(ProcessJob, LatenciesAddUpToATickAProcess) {
  const MusicFile file = job("  - a -> one [2] -> two [2] -> b [2]\n");
  const auto latency = [&](const char* section) {
    return from_seconds(std::stod(key(file, section, "accept_latency")));
  };
  EXPECT_GE(latency("one") + latency("two") + latency("experiment"), 3'000'000);
  EXPECT_LT(latency("one"), 1'000'000);
  EXPECT_LT(latency("two"), 1'000'000);
  EXPECT_LT(latency("experiment"), 2'000'000);
  EXPECT_EQ(key(file, "experiment", "spike_delay"), "1");
  EXPECT_EQ(key(file, "one", "spike_delay"), "none");
  EXPECT_EQ(key(file, "one", "signal_delay"), "none");
}

TEST_F(ProcessJob, DelaysBetweenSimulatorsAreMusics) {
  const auto cells = experiment(
      "  - a -> one [2, delay 2 ticks]\n  - one -> two [2, delay 3 "
      "ticks] -> b [2, delay 4 ticks]\n  - a -> two.more [2, delay 5 "
      "ticks]\n");
  const auto delayed = experiment::with_layout_delays(cells);
  const MusicFile file = experiment::process_job(delayed, "out", {}).file;
  EXPECT_EQ(key(file, "two", "spike_delay"), "3");
  std::vector<std::uint32_t> edges;
  for (const experiment::Connection& connection : delayed.connections) {
    if (connection.from != "one.out" && connection.to != "c.in" && connection.to != "a.in") {
      edges.push_back(connection.delay_ticks.value() -
                      experiment::music_delay(delayed, connection));
    }
  }
  EXPECT_THAT(edges, testing::ElementsAre(2, 2, 2));
}

// The loop computes a tick while the simulators compute the one before: all its spikes may be late.
TEST_F(ProcessJob, ALongerDelayOutOfSimulatorsLetsTheLoopRunATickAhead) {
  const auto keys = [](const experiment::Experiment& cells) {
    const MusicFile file = job_of(cells);
    return key(file, "experiment", "accept_latency") + ", " +
           key(file, "experiment", "spike_delay");
  };
  const auto delayed = [&](const std::string& ticks) {
    return experiment("  - a -> one [2] -> b [2, delay " + ticks + "]\n  - a -> two [2]\n");
  };
  EXPECT_EQ(keys(delayed("1 tick")), "0.001990000, 1");
  EXPECT_EQ(keys(delayed("9 ticks")), "0.002990000, 2") << "no further ahead of one that hangs";
  experiment::Experiment both = delayed("9 ticks");
  Connection other = *std::ranges::find(both.connections, "b.in", &Connection::to);
  other.from = "two.out";
  other.delay_ticks = 1;
  both.connections.push_back(other);
  EXPECT_EQ(keys(both), "0.001990000, 1") << "the shortest of all";
}

TEST_F(ProcessJob, WhatIsNotWrittenWaitsAsLongAsTheInputsFromASimulator) {
  const auto delayed = experiment::with_layout_delays(
      experiment("  - a -> one [2] -> two [2] -> b [2]\n  - two -> one.back [2, delay 3 ticks]\n"
                 "  - c -> one.level [2]\n"));
  std::map<std::string, std::uint32_t> delays;
  for (const experiment::Connection& connection : delayed.connections) {
    delays[connection.to] = connection.delay_ticks.value();
  }
  EXPECT_EQ(delays["one.in"], 3U);
  EXPECT_EQ(delays["one.back"], 3U);
  EXPECT_EQ(delays["two.in"], 0U);
  EXPECT_EQ(delays["one.level"], 2U) << "continuous values wait for their own kind";
  EXPECT_NO_THROW(experiment::process_job(delayed, "out", {}));
}

TEST_F(ProcessJob, NestNeedsTheStampGuard) {
  EXPECT_EQ(key(job("  - a -> two [2] -> b [2]\n  - a -> one [2]\n"), "experiment", "stamp_guard"),
            "true");
}

TEST_F(ProcessJob, TheOthersSectionHasANameOfItsOwn) {
  files_ = std::make_unique<Files>(
      "nodes:\n  a: {node: rate_encoder}\n  c: {node: sigmoid}\n  experiment: {simulator: python, "
      "script: brain.py}\n  b: {node: linear_readout}\nconnections:\n  - c -> a [1] -> experiment "
      "[1] -> b [1] -> c [1, delay 1 tick]\n",
      std::map<std::string, std::string>{{"brain.py", "import spikeloop\n"}});
  const Read result = read(*files_, types_);
  ASSERT_THAT(result.faults, testing::IsEmpty());
  EXPECT_THAT(experiment::process_job(experiment::with_layout_delays(result.experiment), "", {})
                  .file.labels(),
              testing::ElementsAre("experiment_", "experiment"));
}

TEST_F(ProcessJob, RefusesWhatCannotBe) {
  EXPECT_THAT(refusal("  - a -> one [2] -> b [2, delay 0]\n  - a -> two [2]\n"),
              Fault("x.yaml:14:21: spikes from 'one.out' to 'b.in' ... 1 tick in the fused layout "
                    "... 0 ticks ... delay 1 tick ... [SL0310]"));
  EXPECT_THAT(refusal("  - a -> one [2] -> b [2]\n  - a -> two [2]\n  - c -> one.level [2, delay 1 "
                      "tick]\n"),
              Fault("x.yaml:16:10: continuous values from 'c.out' to 'one.level' ... 2 ... 1 tick "
                    "... delay 2 ticks ... [SL0310]"));
  EXPECT_EQ(
      refusal("  - a -> one [2] -> two [2, delay 2 ticks] -> b [2]\n  - a -> two.more [2, delay 1 "
              "tick]\n"),
      "x.yaml:15:10: the inputs 'two.in' and 'two.more' have different delays, and a simulator "
      "waits for all of its inputs as long as for those from another one; write at least "
      "[delay 2 ticks] [SL0310]");
  EXPECT_THAT(
      refusal(
          "  - a -> one [2] -> two [2, delay 1 tick] -> b [2]\n  - a -> two.more [2, delay 0]\n"),
      Fault("x.yaml:15:10: the inputs 'two.in' and 'two.more' ... [delay 1 tick] ... [SL0310]"));
  EXPECT_THAT(
      refusal("  - a -> b [2]\n  - one -> two [2]\n"),
      Fault("x.yaml:6:3: no connection joins the simulators with the other nodes ... and MUSIC "
            "would wait forever; connect them, or use --layout separate ... [SL0305]"));
}

TEST_F(ProcessJob, HasNoOutputWithSoManyReceiversThatMusicCrashes) {
  const auto fault = [&](int receivers) {
    std::string nodes =
        "nodes:\n  a: {simulator: builtin, network: {populations: {p: {model: poisson, size: 2, "
        "parameters: {rate: 1 Hz}}}, output: [p]}}\n";
    std::string connections = "connections:\n";
    for (int i = 0; i < receivers; ++i) {
      nodes += fmt::format("  b{}: {{node: linear_readout}}\n", i);
      connections += fmt::format("  - a -> b{} [2]\n", i);
    }
    files_ = std::make_unique<Files>("experiment: x\nsync: unpaced\nlayout: separate\n" + nodes +
                                     connections);
    return refusal_of(read(*files_, types_).experiment);
  };
  for (const int receivers : {1, 4, 6, 8, 14, 16, 30}) {
    EXPECT_EQ(fault(receivers), "nothing");
  }
  for (const int receivers : {5, 9, 13, 17, 29}) {
    EXPECT_EQ(fault(receivers),
              fmt::format("x.yaml:3:9: {} processes take the spikes 'a__out' of process 'a', and "
                          "MUSIC crashes now and then with 5, 9 to 13 or 17 to 29; put two of them "
                          "into one process [SL0601]",
                          receivers));
  }
}

TEST_F(ProcessJob, AnExportedJobHasAProgramANode) {
  const auto cells = experiment("  - a -> one [2, delay 2 ticks] -> two [2] -> b [2]\n");
  const MusicFile file = experiment::music_job(cells, "out").file;
  EXPECT_THAT(file.labels(), testing::ElementsAre("a", "b", "c", "one", "two"));
  EXPECT_EQ(key(file, "one", "binary"), "spikeloop-script");
  EXPECT_EQ(key(file, "one", "spike_delay"), "2");
  EXPECT_EQ(key(file, "one", "gain"), "3");
  EXPECT_NO_THROW(check_structure(file));
}

}  // namespace
}  // namespace spikeloop::test
