// A section in several processes and threads computes, spike for spike, what one thread does.
#include <gmock/gmock.h>

#include <random>

#include "job.hpp"

namespace spikeloop::test {
namespace {

/// How a section is shared out.
struct Parts {
  int processes;
  int threads;
};
std::string text_of(const Parts& parts) {
  return "np=" + std::to_string(parts.processes) + ", threads=" + std::to_string(parts.threads);
}

constexpr Parts kAlone{1, 1};
constexpr Parts kShared[] = {{2, 1}, {4, 1}, {1, 2}, {2, 2}};

/// Noise that changes every 7 ms, sent as `width` channels.
std::string noise_file(int ticks, int width) {
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> uniform(-1.2, 1.2);
  std::string text;
  for (int tick = 0; tick < ticks; tick += 7) {
    text += std::to_string(tick);
    for (int i = 0; i < width; ++i) {
      text += " " + std::to_string(uniform(generator));
    }
    text += "\n";
  }
  return text;
}

/// The spikes that `program` sends on `neurons` channels for noise on `width` ones.
std::vector<LoggedEvent> spikes_of(const std::string& program, const Parts& parts, int width,
                                   int neurons, const std::string& keys = "") {
  Job job;
  job.global("stoptime=0.3\nsync=unpaced");
  job.raw("sink")
      .ours("cells", program, keys + "threads=" + std::to_string(parts.threads), parts.processes)
      .raw("source", "values=" + job.directory.write("values.txt", noise_file(300, width)));
  job.connect("source.values -> cells.in [" + std::to_string(width) + "]");
  job.connect("cells.out -> sink.spikes_in [" + std::to_string(neurons) + "]");
  expect_clean(job.run());
  return job.events("sink");
}

void expect_the_same_spikes(const std::string& program, int width, int neurons,
                            const std::string& keys, std::size_t least) {
  const auto expected = spikes_of(program, kAlone, width, neurons, keys);
  EXPECT_GT(expected.size(), least);
  for (const Parts& parts : kShared) {
    EXPECT_EQ(spikes_of(program, parts, width, neurons, keys), expected) << text_of(parts);
  }
}

TEST(Sharing, NefSpikesAreTheSame) {
  expect_the_same_spikes("nef_encoder", 1, 203, "preset=nengo\n", 3000);
}

TEST(Sharing, InterpolatedNefSpikesAreTheSame) {
  expect_the_same_spikes("nef_encoder", 1, 203, "preset=nengo\nspike_times=interpolated\n", 3000);
}

TEST(Sharing, RateSpikesAreTheSame) {
  expect_the_same_spikes("rate_encoder", 29, 29, "", 300);
}

TEST(Sharing, PoissonSpikesAreTheSame) {
  expect_the_same_spikes("poisson_encoder", 29, 29, "", 300);
}

/// Values of a readout of 20 channels with four rows.
std::vector<std::vector<double>> readout_of(const Parts& parts, const std::string& weights) {
  std::string schedule;
  for (int tick = 0; tick < 200; ++tick) {
    schedule += std::to_string(tick) + " " + std::to_string(tick * 1e-3 + 3e-4) + " " +
                std::to_string(tick * 7 % 20) + "\n";
  }
  Job job;
  job.global("stoptime=0.2\nsync=unpaced");
  job.raw("sink")
      .ours("readout", "linear_readout_decoder",
            "accept_latency=0\nweights=" + job.directory.write("weights.json", weights) +
                "\nthreads=" + std::to_string(parts.threads),
            parts.processes)
      .raw("source", "spikes=" + job.directory.write("spikes.txt", schedule));
  job.connect("source.spikes -> readout.in [20]").connect("readout.out -> sink.values_in [4]");
  expect_clean(job.run());
  return job.values("sink");
}

void expect_the_same_readout(const std::string& weights) {
  const auto expected = readout_of(kAlone, weights);
  ASSERT_EQ(expected.size(), 200U);
  EXPECT_NE(expected.back(), expected[2]);
  for (const Parts& parts : kShared) {
    const auto found = readout_of(parts, weights);
    ASSERT_EQ(found.size(), expected.size()) << text_of(parts);
    for (std::size_t k = 1; k < found.size(); ++k) {  // before the first tick nothing is known
      ASSERT_EQ(found[k], expected[k]) << k << ", " << text_of(parts);
    }
  }
}

TEST(Sharing, ADecoderIsSharedOutByOutputs) {
  std::string dense = "[";
  for (int row = 0; row < 4; ++row) {
    dense += row == 0 ? "[" : ", [";
    for (int column = 0; column < 20; ++column) {
      dense += (column == 0 ? "" : ", ") + std::to_string(0.1 * row - 0.03 * column);
    }
    dense += "]";
  }
  expect_the_same_readout(dense + "]");
}

TEST(Sharing, ADecoderOfFewWeightsIsSharedOutByOutputs) {
  expect_the_same_readout(
      R"({"rows": 4, "columns": 20, "entries": [[0, 7, 1.5], [1, 0, 2], [3, 14, -1], [3, 1, 0.25]]})");
}

Outcome outcome_of(const std::string& program, const std::string& keys, int processes,
                   int width = 3) {
  Job job;
  job.global("stoptime=0.02\nsync=unpaced");
  job.raw("source", "values=" + job.directory.write("values.txt", noise_file(20, width)));
  job.ours("cells", program, keys, processes);
  job.raw("sink");
  job.connect("source.values -> cells.in [" + std::to_string(width) + "]");
  job.connect("cells.out -> sink." +
              std::string(program == "argmax_adapter" ? "values" : "spikes") + "_in [" +
              std::to_string(width) + "]");
  return job.run();
}

TEST(SharingError, OnlyClassesThatCanShareDo) {
  Outcome outcome = outcome_of("argmax_adapter", "", 2);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(
      outcome.says("np=2 and threads=1, but a node of the class argmax cannot be shared "
                   "out; write np=1, and leave out threads"));
  EXPECT_EQ(outcome.left_behind, 0);
  outcome = outcome_of("argmax_adapter", "threads=2\n", 1);
  EXPECT_TRUE(outcome.says("np=1 and threads=2, but a node of the class argmax cannot be shared"));
}

TEST(SharingError, EachPartNeedsAChannel) {
  const Outcome outcome = outcome_of("rate_encoder", "threads=2\n", 2);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(
      outcome.says("port 'out' has 3 channels, too few for 4 parts (np times threads); "
                   "write smaller ones"));
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST(SharingError, AValueThatOneProcessRefusesEndsTheJob) {
  const Outcome outcome = outcome_of("rate_encoder", "out_of_range=error\nthreads=1\n", 3, 9);
  EXPECT_EQ(outcome.exit_code, 5);
  EXPECT_TRUE(outcome.says("scale the signal before this node"));
  EXPECT_EQ(outcome.left_behind, 0);
}

}  // namespace
}  // namespace spikeloop::test
