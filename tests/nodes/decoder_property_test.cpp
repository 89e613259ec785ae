// Decoders and adapters under random parameters, ticks, spikes (late ones too) and inputs: whatever
// comes, they end and their outputs are numbers, which simple rules give as well.
#include <map>
#include <optional>

#include "random_trial.hpp"

namespace spikeloop::testing {
namespace {

using Keys = std::map<std::string, std::string>;

// Random spikes, many or none; `after(all)` runs after every tick.
template <typename After>
void fire_randomly(RandomTrial& random, NodeHarness& node, std::int32_t channels, After&& after) {
  std::vector<Spike> all;
  for (int i = 0; i < 150; ++i) {
    const TimeNs tick = random.chance(0.05) ? 20 * kNsPerSecond : random.tick();
    for (int count = random.pick<int>({0, 0, 1, 5, 40}); count > 0; --count) {
      all.push_back(random.spike(node.time(), tick, channels));
      if (random.chance(0.3)) {
        all.back().time_ns = node.time() + tick;  // several at one moment
      }
      node.add_spike(all.back().time_ns, all.back().channel);
    }
    node.step(tick);
    expect_finite(node);
    after(all);
  }
  ASSERT_EQ(node.counter("spikes"), all.size());
}

TEST(DecoderProperty, PopulationVectorStaysBetweenWhatNeuronsPrefer) {
  run_trials(100, [](RandomTrial& random) {
    const bool circular = random.chance(0.5);
    const Keys keys = {{"tau", random.word({"1 us", "1 ms", "30 ms", "1e6"})},
                       {"circular", circular ? "true" : "false"},
                       {"value_min", random.word({"-1", "-1e9"})},
                       {"value_max", random.word({"1", "1e9"})}};
    NodeHarness node("population_vector", {8, 2}, {.keys = keys});
    const double low = keys.at("value_min") == "-1" ? -1 : -1e9;
    const double high = keys.at("value_max") == "1" ? 1 : 1e9;
    const double slack = 1e-12 * (high - low);
    std::size_t spikes = 0;
    std::uint64_t revision = 0;
    fire_randomly(random, node, 8, [&](const std::vector<Spike>& all) {
      for (std::size_t k = 0; k < 2 && node.revision() > 0; ++k) {
        ASSERT_GE(node.output()[k], low - slack);
        ASSERT_LE(node.output()[k], high + slack);
      }
      ASSERT_TRUE(all.size() > spikes || node.revision() == revision) << "a change without a spike";
      spikes = all.size();
      revision = node.revision();
    });
  });
}

TEST(DecoderProperty, WinnerTakeAllHasOneWinner) {
  run_trials(100, [](RandomTrial& random) {
    const std::string output = random.word({"one_hot", "index", "rate"});
    const Keys keys = {{"tau", random.word({"1 us", "1 ms", "30 ms", "1e6"})},
                       {"margin", random.word({"0", "0.2", "1e9"})},
                       {"output", output}};
    NodeHarness node("winner_take_all", {5, output == "index" ? 1U : 5U}, {.keys = keys});
    fire_randomly(random, node, 5, [&](const std::vector<Spike>& all) {
      if (node.revision() == 0) {
        return;
      }
      ASSERT_FALSE(all.empty());
      if (output == "index") {
        const double index = node.output()[0];
        ASSERT_TRUE(index >= 0 && index <= 4 && index == std::floor(index)) << index;
        return;
      }
      const auto winners =
          std::ranges::count_if(node.output(), [](double value) { return value > 0; });
      ASSERT_TRUE(winners == 1 || (output == "rate" && winners == 0)) << winners;
    });
  });
}

TEST(DecoderProperty, RateWindowCountsExactly) {
  run_trials(60, [](RandomTrial& random) {
    const TimeNs window = random.pick<TimeNs>({1'000, 5 * kMs, 123'456'789, 60 * kNsPerSecond});
    NodeHarness node("rate_window", {4, 4}, {.keys = {{"window", fmt::format("{} ns", window)}}});
    fire_randomly(random, node, 4, [&](const std::vector<Spike>& all) {
      std::vector<double> counts(4, 0.0);
      for (const Spike& spike : all) {
        if (spike.time_ns > node.time() - window) {
          counts[static_cast<std::size_t>(spike.channel)] += 1;
        }
      }
      for (std::size_t c = 0; c < 4; ++c) {
        ASSERT_NEAR(node.output()[c] * to_seconds(window), counts[c], 1e-6);
      }
    });
  });
}

// The same random inputs for each adapter; `expected(value)` is what an output must be now, and is
// not asked while the input is invalid.
template <typename Expected>
void feed_randomly(RandomTrial& random, NodeHarness& node, bool zero, Expected&& expected) {
  std::vector<double> held(3, 0.0);
  bool valid = false;
  for (int i = 0; i < 200; ++i) {
    if (random.chance(0.5)) {
      const std::vector<double> values = random.values(3);
      node.set_input(values);
      valid = true;
      for (std::size_t c = 0; c < 3; ++c) {
        held[c] = std::isfinite(values[c]) ? values[c] : zero ? 0.0 : held[c];
      }
    } else if (random.chance(0.05)) {
      node.invalidate_input();
      valid = false;
      held.assign(3, 0.0);
    }
    node.step(random.tick());
    expect_finite(node);
    ASSERT_EQ(node.revision() != 0, valid);
    for (std::size_t c = 0; c < 3 && valid; ++c) {
      expected(node, c, held[c]);
    }
  }
}

TEST(AdapterProperty, LowPassStaysBetweenTheExtremes) {
  run_trials(100, [](RandomTrial& random) {
    const bool zero = random.chance(0.5);
    NodeHarness node("low_pass", {3, 3},
                     {.keys = {{"tau", random.word({"1 us", "1 ms", "1e6"})},
                               {"initial", random.word({"none", "0", "1e300"})},
                               {"not_finite", zero ? "zero" : "hold"}}});
    std::vector<double> lowest(3, 0.0);
    std::vector<double> highest(3, 1e300);
    feed_randomly(random, node, zero, [&](const NodeHarness& seen, std::size_t c, double x) {
      lowest[c] = std::min(lowest[c], x);
      highest[c] = std::max(highest[c], x);
      ASSERT_GE(seen.output()[c], lowest[c]);
      ASSERT_LE(seen.output()[c], highest[c]);
    });
  });
}

TEST(AdapterProperty, FunctionIsWhatItSays) {
  run_trials(60, [](RandomTrial& random) {
    const bool zero = random.chance(0.5);
    NodeHarness node(
        "function", {3, 3},
        {.keys = {{"function", "x0 < 0 ? -1 : 1; max(x1, -1); x2 == 0 ? 0 : abs(x2) / x2"},
                  {"not_finite", zero ? "zero" : "hold"}}});
    feed_randomly(random, node, zero, [&](const NodeHarness& seen, std::size_t c, double x) {
      const double sign = x > 0 ? 1.0 : x < 0 ? -1.0 : 0.0;
      const double expected = c == 0 ? (x < 0 ? -1.0 : 1.0) : c == 1 ? std::max(x, -1.0) : sign;
      ASSERT_EQ(seen.output()[c], expected) << c << " of " << x;
    });
  });
}

TEST(AdapterProperty, FunctionNeverGivesWhatIsNoNumber) {
  run_trials(60, [](RandomTrial& random) {
    const std::string text =
        random.word({"1/x0; x1^x2", "ln(x0); x1*x1*x2", "acosh(x0); exp(x1) - exp(x2)",
                     "x0/x1; sqrt(x2) + atanh(x0)"});
    NodeHarness node("function", {3, 2},
                     {.keys = {{"function", text}, {"not_finite", random.word({"zero", "hold"})}}});
    for (int i = 0; i < 100; ++i) {
      node.set_input(random.values(3));
      node.step(random.tick());
      expect_finite(node);
    }
  });
}

TEST(AdapterProperty, ClipAndNormaliseStayInTheirRange) {
  run_trials(60, [](RandomTrial& random) {
    const bool zero = random.chance(0.5);
    const Keys policy = {{"not_finite", zero ? "zero" : "hold"}};
    // After an invalid input these adapters still hold the values before.
    NodeHarness clip("clip", {3, 3}, {.keys = policy});
    NodeHarness normalise("normalise", {3, 3}, {.keys = policy});
    Keys free = policy;
    free["clip"] = "false";
    free["in_max"] = random.word({"1", "1e-100", "1e100"});
    free["out_max"] = random.word({"1", "-1", "1e100"});
    NodeHarness extrapolating("normalise", {3, 3}, {.keys = free});
    for (NodeHarness* node : {&clip, &normalise}) {
      feed_randomly(random, *node, zero, [](const NodeHarness& seen, std::size_t c, double) {
        ASSERT_LE(std::fabs(seen.output()[c]), 1.0);
      });
    }
    feed_randomly(random, extrapolating, zero, [](const NodeHarness&, std::size_t, double) {});
  });
}

TEST(AdapterProperty, DelayGivesBackWhatWentIn) {
  run_trials(100, [](RandomTrial& random) {
    const bool zero = random.chance(0.5);
    const TimeNs delay = random.pick<TimeNs>({0, 1, kMs, 10 * kMs, kNsPerSecond});
    NodeHarness node(
        "delay", {3, 3},
        {.keys = {{"delay", fmt::format("{} ns", delay)}, {"not_finite", zero ? "zero" : "hold"}}});
    std::vector<std::pair<TimeNs, std::optional<std::vector<double>>>> past;
    std::vector<double> held(3, 0.0);
    for (int i = 0; i < 200; ++i) {
      const TimeNs now = node.time();
      if (random.chance(0.5)) {
        const std::vector<double> values = random.values(3);
        node.set_input(values);
        for (std::size_t c = 0; c < 3; ++c) {
          held[c] = std::isfinite(values[c]) ? values[c] : zero ? 0.0 : held[c];
        }
        past.emplace_back(now, held);
      } else if (random.chance(0.05)) {
        node.invalidate_input();
        held.assign(3, 0.0);
        past.emplace_back(now, std::nullopt);
      }
      node.step(random.tick());
      std::optional<std::vector<double>> expected;
      for (const auto& [time, values] : past) {
        expected = time <= now - delay ? values : expected;
      }
      ASSERT_EQ(node.revision() != 0, expected.has_value());
      if (expected) {
        ASSERT_EQ(node.output(), *expected);
      }
    }
  });
}

}  // namespace
}  // namespace spikeloop::testing
