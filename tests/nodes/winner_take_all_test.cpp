// The winner against a search over all rates, computed anew at every spike.
#include <cmath>
#include <set>

#include "spike_trains.hpp"

namespace spikeloop::testing {
namespace {

using Keys = std::map<std::string, std::string>;

// The winner at `now`, after every moment at which spikes came; -1: none.
class Contest {
 public:
  Contest(std::vector<Spike> spikes, std::size_t channels, double tau, double margin)
      : spikes_(std::move(spikes)), rates_(channels, 0.0L), tau_(tau), margin_(margin) {}

  int winner_at(TimeNs now) {
    while (next_ < spikes_.size() && spikes_[next_].time_ns <= now) {
      const TimeNs time = spikes_[next_].time_ns;
      decay_to(time);
      while (next_ < spikes_.size() && spikes_[next_].time_ns == time) {
        rates_[static_cast<std::size_t>(spikes_[next_++].channel)] += 1;
      }
      judge();
    }
    return winner_;
  }
  long double rate_at(int channel, TimeNs now) const {
    const long double age = static_cast<long double>(now - time_) * 1e-9L;
    return rates_[static_cast<std::size_t>(channel)] * std::exp(-age / tau_) / tau_;
  }
  std::uint64_t changes = 0;
  long double closest = 1;  // how near, relatively, any decision was to the other one

 private:
  void decay_to(TimeNs time) {
    for (long double& rate : rates_) {
      rate *= std::exp(-static_cast<long double>(time - time_) * 1e-9L / tau_);
    }
    time_ = time;
  }
  void judge() {
    const int best =
        static_cast<int>(std::max_element(rates_.begin(), rates_.end()) - rates_.begin());
    if (winner_ < 0) {
      winner_ = best;
      return;
    }
    const long double needed = rates_[static_cast<std::size_t>(winner_)] * (1 + margin_);
    const long double reached = rates_[static_cast<std::size_t>(best)];
    if (best != winner_) {
      closest = std::min(closest, std::fabs(reached - needed) / needed);
    }
    if (reached > needed) {
      winner_ = best;
      ++changes;
    }
  }

  std::vector<Spike> spikes_;
  std::vector<long double> rates_;
  double tau_;
  long double margin_;
  std::size_t next_ = 0;
  TimeNs time_ = 0;
  int winner_ = -1;
};

TEST(WinnerTakeAll, EqualsASearchOverAllRates) {
  for (const double margin : {0.0, 0.1, 0.5, 2.0}) {
    // A grid of 1 ns: rates are never equal.
    const auto spikes = random_spikes(3000, 6, 3 * kNsPerSecond, 8, 1);
    Contest contest(spikes, 6, 0.03, margin);
    NodeHarness node("winner_take_all", {6, 6}, {.keys = {{"margin", std::to_string(margin)}}});
    std::set<int> winners;
    play(node, spikes, 3 * kNsPerSecond, kMs, [&] {
      const int winner = contest.winner_at(node.time());
      winners.insert(winner);
      ASSERT_EQ(node.revision() == 0, winner < 0) << node.time();
      for (int c = 0; c < 6 && winner >= 0; ++c) {
        ASSERT_EQ(node.output()[static_cast<std::size_t>(c)], c == winner ? 1 : 0)
            << node.time() << ", margin " << margin;
      }
    });
    EXPECT_GE(winners.size(), 6U) << margin;
    EXPECT_GT(contest.closest, 1e-12L) << "the comparison above is free of rounding";
    EXPECT_EQ(node.counter("winner_changes"), contest.changes);
    EXPECT_EQ(node.counter("spikes"), 3000U);
  }
}

TEST(WinnerTakeAll, IndexAndRateTellOfTheSameWinner) {
  const auto spikes = random_spikes(500, 4, kNsPerSecond, 9, 1);
  Contest contest(spikes, 4, 0.02, 0.2);
  const Keys keys = {{"margin", "0.2"}, {"tau", "20 ms"}};
  Keys index_keys = keys;
  index_keys["output"] = "index";
  Keys rate_keys = keys;
  rate_keys["output"] = "rate";
  NodeHarness index("winner_take_all", {4, 1}, {.keys = index_keys});
  NodeHarness rate("winner_take_all", {4, 4}, {.keys = rate_keys});
  std::vector<int> winners;
  play(index, spikes, kNsPerSecond, 10 * kMs, [&] {
    winners.push_back(contest.winner_at(index.time()));
    ASSERT_EQ(index.output()[0], winners.back());
  });
  Contest again(spikes, 4, 0.02, 0.2);
  play(rate, spikes, kNsPerSecond, 10 * kMs, [&] {
    const int winner = again.winner_at(rate.time());
    for (int c = 0; c < 4; ++c) {
      const double expected =
          c == winner ? static_cast<double>(again.rate_at(c, rate.time())) : 0.0;
      ASSERT_NEAR(rate.output()[static_cast<std::size_t>(c)], expected, 1e-10);
    }
  });
}

TEST(WinnerTakeAll, TheWinnerStaysUntilItIsExceededByTheMargin) {
  NodeHarness node("winner_take_all", {2, 1},
                   {.keys = {{"tau", "1e6"}, {"margin", "0.6"}, {"output", "index"}}});
  const auto fire = [&](std::int32_t channel) {
    node.add_spike(node.time() + kMs, channel);
    node.step(kMs);
    return node.output()[0];
  };
  EXPECT_EQ(fire(1), 1);
  EXPECT_EQ(fire(1), 1);
  EXPECT_EQ(fire(0), 1);
  EXPECT_EQ(fire(0), 1) << "2 against 2";
  EXPECT_EQ(fire(0), 1) << "3 do not exceed 1.6 times 2";
  EXPECT_EQ(fire(0), 0) << "4 do";
  EXPECT_EQ(fire(1), 0);
}

TEST(WinnerTakeAll, OfEqualOnesTheLowestChannelWins) {
  NodeHarness node("winner_take_all", {5, 1}, {.keys = {{"output", "index"}}});
  const auto fire = [&](const std::vector<std::int32_t>& channels) {
    for (const std::int32_t channel : channels) node.add_spike(node.time() + kMs, channel);
    node.step(kMs);
    return node.output()[0];
  };
  EXPECT_EQ(fire({4, 2, 3}), 2);
  EXPECT_EQ(fire({1, 3, 3, 4, 4}), 3) << "2.97 each, channel 3 stands before 4";
  NodeHarness held("winner_take_all", {3, 1}, {.keys = {{"output", "index"}}});
  held.add_spike(kMs, 2);
  held.step(2 * kMs);
  held.add_spike(kMs, 0);  // late, and equal to the winner: it stays
  held.step(kMs);
  EXPECT_EQ(held.output()[0], 2);
  EXPECT_EQ(held.counter("late_spikes"), 1U);
  EXPECT_EQ(held.counter("winner_changes"), 0U);
}

TEST(WinnerTakeAll, TheWinnerDoesNotDependOnTheTick) {
  const auto spikes = random_spikes(4000, 5, 5 * kNsPerSecond);
  for (const char* output : {"one_hot", "rate"}) {
    std::vector<std::vector<double>> reference;
    for (const TimeNs tick : {50 * kMs, 10 * kMs, kMs, kMs / 10}) {
      NodeHarness node("winner_take_all", {5, 5},
                       {.keys = {{"margin", "0.3"}, {"tau", "1 ms"}, {"output", output}}});
      const auto outputs = outputs_at(node, spikes, 5 * kNsPerSecond, tick, 50 * kMs);
      reference = reference.empty() ? outputs : reference;
      EXPECT_EQ(outputs, reference) << "bit by bit, tick " << tick;
    }
  }
}

TEST(WinnerTakeAll, SilenceKeepsTheWinnerAndItsRateDecays) {
  NodeHarness node("winner_take_all", {3, 3});
  NodeHarness rate("winner_take_all", {3, 3}, {.keys = {{"output", "rate"}}});
  for (NodeHarness* each : {&node, &rate}) {
    each->run_until(10 * kMs, kMs);
    EXPECT_EQ(each->revision(), 0U) << "invalid before the first spike";
    each->add_spike(11 * kMs, 1);
    each->step(kMs);
  }
  rate.run_until(41 * kMs, kMs);
  EXPECT_NEAR(rate.output()[1], std::exp(-1.0) / 0.03, 1e-12);
  node.run_until(100 * kNsPerSecond, 50 * kMs);
  rate.run_until(100 * kNsPerSecond, 50 * kMs);
  EXPECT_EQ(node.output(), (std::vector<double>{0, 1, 0}));
  EXPECT_EQ(node.revision(), 1U);
  EXPECT_EQ(rate.output(), (std::vector<double>{0, 0, 0}));
  for (NodeHarness* each : {&node, &rate}) {
    each->add_spike(each->time() + kMs, 2);
    each->step(kMs);
  }
  EXPECT_EQ(node.output(), (std::vector<double>{0, 0, 1}));
  EXPECT_DOUBLE_EQ(rate.output()[2], 1 / 0.03);
}

TEST(WinnerTakeAll, WhatDoesNotFitIsRefused) {
  EXPECT_EQ(
      message_of([] {
        NodeHarness("winner_take_all", {3, 2});
      }),
      "port 'in' has 3 channels and port 'out' 2; make both connections equally wide [SL0306]");
  EXPECT_EQ(message_of([] {
              NodeHarness("winner_take_all", {3, 3}, {.keys = {{"output", "index"}}});
            }),
            "port 'out' has 3 channels, but an index is one value; write [1] in its connection, or "
            "output = one_hot [SL0306]");
  EXPECT_THAT(message_of([] {
                NodeHarness("winner_take_all", {3, 3}, {.keys = {{"output", "winner"}}});
              }),
              Fault("test.yaml:7:3: key 'output': 'winner' ... one_hot, index, rate ... [SL0205]"));
  EXPECT_THAT(message_of([] {
                NodeHarness("winner_take_all", {3, 3}, {.keys = {{"margin", "-0.1"}}});
              }),
              Fault("test.yaml:7:3: key 'margin': -0.1 ... 0 to 1000000000 ... [SL0203]"));
  NodeHarness node("winner_take_all", {3, 3});
  node.add_spike(kMs, 3);
  EXPECT_THAT(message_of([&] { node.step(kMs); }),
              Fault("a spike came on channel 3 ... 'in' ... 0 to 2 ..."));
}

}  // namespace
}  // namespace spikeloop::testing
