// Signals through our programs under MUSIC. The value that a program puts out for the end of tick
// k, sender time (k+1)h, is what the receiver sees in its tick k+1: one tick a hop.
#include "job.hpp"

namespace spikeloop::test {
namespace {

std::string values_file(const std::vector<std::vector<double>>& rows) {
  std::string text;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    text += std::to_string(k);
    for (const double value : rows[k]) {
      char number[40];
      std::snprintf(number, sizeof number, " %.17g", value);
      text += number;
    }
    text += "\n";
  }
  return text;
}

std::vector<std::vector<double>> ramp(int ticks, int width) {
  std::vector<std::vector<double>> rows;
  for (int k = 0; k < ticks; ++k) {
    rows.emplace_back();
    for (int i = 0; i < width; ++i) {
      rows.back().push_back(k + 0.1 * i);
    }
  }
  return rows;
}

bool all_nan(const std::vector<double>& values) {
  for (const double value : values) {
    if (!std::isnan(value)) {
      return false;
    }
  }
  return true;
}

class SignalsEitherOrder : public testing::TestWithParam<bool> {};

TEST_P(SignalsEitherOrder, EachHopCostsExactlyOneTick) {
  const auto sent = ramp(60, 3);
  Job job;
  job.global("stoptime=0.06");
  const std::string source = "values=" + job.directory.write("values.txt", values_file(sent));
  if (GetParam()) {
    job.raw("sink").node("relay", "signal_relay").raw("source", source);
  } else {
    job.raw("source", source).node("relay", "signal_relay").raw("sink");
  }
  job.connect("source.values -> relay.in [3]").connect("relay.out -> sink.values_in [3]");
  expect_clean(job.run());
  const auto seen = job.values("sink");
  ASSERT_EQ(seen.size(), 60u);
  // Tick k of the source, tick k+1 of the relay, which puts it out in the same tick, tick k+2 here.
  EXPECT_TRUE(all_nan(seen[0]));
  EXPECT_TRUE(all_nan(seen[1]));
  for (std::size_t k = 2; k < seen.size(); ++k) {
    EXPECT_EQ(seen[k], sent[k - 2]) << "tick " << k;
  }
}
INSTANTIATE_TEST_SUITE_P(Sections, SignalsEitherOrder, testing::Values(true, false),
                         [](const auto& test) {
                           return test.param ? "DownstreamFirst" : "UpstreamFirst";
                         });

TEST(Signals, AllNanMeansNoValueAndOneNanIsAnInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::vector<double>> sent = {{nan, nan}, {nan, nan},  {0.5, nan}, {0.5, 0.25},
                                                 {nan, nan}, {0.5, 0.25}, {0.5, 0.25}};
  Job job;
  job.global("stoptime=0.009");
  job.raw("sink")
      .node("relay", "signal_relay")
      .raw("source", "values=" + job.directory.write("values.txt", values_file(sent)))
      .connect("source.values -> relay.in [2]")
      .connect("relay.out -> sink.values_in [2]");
  expect_clean(job.run());
  const auto seen = job.values("sink");
  ASSERT_EQ(seen.size(), 9u);
  for (std::size_t k = 2; k < seen.size(); ++k) {
    for (std::size_t i = 0; i < 2; ++i) {
      const double wanted = sent[k - 2][i];
      EXPECT_TRUE(std::isnan(wanted) ? std::isnan(seen[k][i]) : seen[k][i] == wanted)
          << "tick " << k << " channel " << i << ": " << seen[k][i];
    }
  }
}

TEST(Signals, AClosedLoopOfTwoNeedsADelayOfATickAHop) {
  const auto sent = ramp(40, 1);
  Job job;
  job.global("stoptime=0.04");
  job.node("relay", "signal_relay", "signal_delay=2")
      .raw("body", "values=" + job.directory.write("values.txt", values_file(sent)))
      .connect("body.values -> relay.in [1]")
      .connect("relay.out -> body.values_in [1]");
  expect_clean(job.run());
  const auto seen = job.values("body");
  ASSERT_EQ(seen.size(), 40u);
  for (std::size_t k = 4; k < seen.size(); ++k) {
    EXPECT_EQ(seen[k], sent[k - 4]) << "tick " << k;
  }
}

class SignalDelay : public testing::TestWithParam<int> {};

TEST_P(SignalDelay, IsExactInWholeTicks) {
  const auto delay = static_cast<std::size_t>(GetParam());
  const auto sent = ramp(30, 2);
  Job job;
  job.global("stoptime=0.03");
  job.raw("sink")
      .node("relay", "signal_relay", "signal_delay=" + std::to_string(delay))
      .raw("source", "values=" + job.directory.write("values.txt", values_file(sent)))
      .connect("source.values -> relay.in [2]")
      .connect("relay.out -> sink.values_in [2]");
  expect_clean(job.run());
  const auto seen = job.values("sink");
  ASSERT_EQ(seen.size(), 30u);
  for (std::size_t k = 0; k < 2 + delay; ++k) {
    EXPECT_TRUE(all_nan(seen[k])) << "tick " << k;
  }
  for (std::size_t k = 2 + delay; k < seen.size(); ++k) {
    EXPECT_EQ(seen[k], sent[k - 2 - delay]) << "tick " << k;
  }
}
INSTANTIATE_TEST_SUITE_P(Ticks, SignalDelay, testing::Values(1, 2, 5));

TEST(Signals, RealNodesAgreeWithTheory) {
  // A constant 0.5 with rates 0 .. 100 Hz is 75 Hz: regular spikes every 13.333.. ms, from when the
  // value has come, the second tick on.
  Job job;
  job.global("stoptime=0.5");
  job.raw("sink")
      .ours("encoder", "rate_encoder", "rate_min=0\nrate_max=100")
      .raw("source", "values=" + job.directory.write("values.txt", "0 0.5\n"))
      .connect("source.values -> encoder.in [1]")
      .connect("encoder.out -> sink.spikes_in [1]");
  expect_clean(job.run());
  const auto events = job.events("sink");
  ASSERT_EQ(events.size(), 37u);  // floor(0.499 * 75)
  for (std::size_t i = 0; i < events.size(); ++i) {
    EXPECT_NEAR(events[i].seconds, 0.001 + static_cast<double>(i + 1) / 75.0, 1e-8);
  }
}

TEST(Signals, ADecoderFiltersASpikeAsTheoryBids) {
  // One spike at 10.5 ms with weight 2: 2 / tau * exp(-(t - 10.5 ms) / tau).
  Job job;
  job.global("stoptime=0.06");
  job.directory.write("w.json", "[[2.0]]");
  job.raw("sink")
      .ours("decoder", "linear_readout_decoder",
            "tau=0.02\nweights_filename=w.json\naccept_latency=0")
      .raw("source", "spikes=" + job.directory.write("spikes.txt", "10 0.0105 0\n"))
      .connect("source.spikes -> decoder.in [1]")
      .connect("decoder.out -> sink.values_in [1]");
  expect_clean(job.run());
  const auto seen = job.values("sink");
  ASSERT_EQ(seen.size(), 60u);
  for (std::size_t k = 1; k < seen.size(); ++k) {
    const double t = static_cast<double>(k) * 1e-3;  // of the value that arrives for tick k
    const double wanted = t < 0.0105 ? 0.0 : 2 / 0.02 * std::exp(-(t - 0.0105) / 0.02);
    EXPECT_NEAR(seen[k][0], wanted, 1e-9) << "tick " << k;
  }
}

TEST(Signals, MissingWeightsAreTheMeanWithAWarningUnlessStrict) {
  for (const bool strict : {false, true}) {
    Job job;
    job.global("stoptime=0.01");
    job.raw("sink")
        .ours("mean", "connect_adapter", strict ? "strict=true" : "")
        .raw("source", "values=" + job.directory.write("values.txt", "0 1 2 6\n"))
        .connect("source.values -> mean.in [3]")
        .connect("mean.out -> sink.values_in [1]");
    const auto outcome = job.run();
    EXPECT_TRUE(outcome.says("there is no weight file 'connection_weights.dat'")) << outcome.text();
    if (strict) {
      EXPECT_EQ(outcome.exit_code, 2);
      continue;
    }
    expect_clean(outcome);
    EXPECT_TRUE(outcome.says("mean: warning: "));
    EXPECT_NEAR(job.values("sink").back().at(0), 3.0, 1e-15);
  }
}

// A signal through one of the programs of music-adapters; the values that come out at the end.
std::vector<double> through(Job& job, const std::string& program, const std::string& keys,
                            const std::string& values, int inputs, int outputs) {
  job.global("stoptime=0.01");
  job.raw("sink")
      .ours("middle", program, keys)
      .raw("source", "values=" + job.directory.write("values.txt", values))
      .connect("source.values -> middle.in [" + std::to_string(inputs) + "]")
      .connect("middle.out -> sink.values_in [" + std::to_string(outputs) + "]");
  expect_clean(job.run());
  return job.values("sink").back();
}

TEST(Family, MapsSignalsUnderItsNamesKeysAndFiles) {
  Job threshold;
  EXPECT_EQ(through(threshold, "threshold_adapter", "threshold=0.5\nis_heaviside=false\nscale=2",
                    "0 0.25 0.75\n", 2, 2),
            (std::vector<double>{0, 1.5}));
  Job sigmoid;
  EXPECT_EQ(through(sigmoid, "sigmoid_adapter", "scale=4\ny_offset=1", "0 0\n", 1, 1),
            std::vector<double>{3});
  Job argmax;
  EXPECT_EQ(through(argmax, "argmax_adapter", "", "0 1 3 2\n", 3, 1), std::vector<double>{1});
  Job discretize;
  discretize.directory.write("grid_positions.json", "[[0, 0.5], [1, 0.5]]");
  const auto cells = through(discretize, "discretize_adapter", "", "0 0\n", 1, 2);
  EXPECT_EQ(cells[0], 1);
  EXPECT_NEAR(cells[1], 2 * std::exp(-2) - 1, 1e-15);
  Job matrix;
  matrix.directory.write("weights.json", "[[1, 2]]");
  EXPECT_EQ(through(matrix, "cont_cont_adapter", "", "0 0.25 0.5\n", 2, 1),
            std::vector<double>{1.25});
}

TEST(Family, AGridThatIsMissingIsAnError) {
  Job job;
  job.global("stoptime=0.01");
  job.raw("sink")
      .ours("cells", "discretize_adapter", "grid_positions_filename=places.json")
      .raw("source", "values=" + job.directory.write("values.txt", "0 0\n"))
      .connect("source.values -> cells.in [1]")
      .connect("cells.out -> sink.values_in [2]");
  const auto outcome = job.run();
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(outcome.says("there is no grid file 'places.json'")) << outcome.text();
}

// music-adapters, linear decoder: each channel by itself, (1/tau) exp(-t/tau).
TEST(Family, LinearDecoderFiltersEachChannel) {
  Job job;
  job.global("stoptime=0.03");
  job.raw("sink")
      .ours("decoder", "linear_decoder", "tau=0.02")
      .raw("source", "spikes=" + job.directory.write("spikes.txt", "10 0.0105 1\n"))
      .connect("source.spikes -> decoder.in [2]")
      .connect("decoder.out -> sink.values_in [2]");
  expect_clean(job.run());
  const auto seen = job.values("sink");
  for (std::size_t k = 1; k < seen.size(); ++k) {
    const double t = static_cast<double>(k) * 1e-3;
    EXPECT_EQ(seen[k][0], 0);
    EXPECT_NEAR(seen[k][1], t < 0.0105 ? 0.0 : 50 * std::exp(-(t - 0.0105) / 0.02), 1e-9) << k;
  }
}

}  // namespace
}  // namespace spikeloop::test
