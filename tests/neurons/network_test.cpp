// Repeaters, delays, multiplicity, refractory period, late spikes, ports, the node class.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <random>

#include "run_network.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::test {
namespace {

using Pairs = std::vector<std::pair<TimeNs, int>>;

std::string relay(const std::string& resolution, const std::string& delay, int size = 1) {
  return fmt::format(
      "resolution: {}\n"
      "populations:\n"
      "  input: {{model: input, size: {}}}\n"
      "  relay: {{model: repeater, size: {}}}\n"
      "connections:\n"
      "  - {{from: input, to: relay, rule: one_to_one, delay: {}}}\n"
      "output: [relay]\n",
      resolution, size, size, delay);
}

TEST(Repeater, RepeatsEverySpikeOnceRoundedUpToTheGrid) {
  const Spikes input = {make_spike(1, 0), make_spike(ms(1.0), 0), make_spike(ms(1.05), 0),
                        make_spike(ms(1.1), 0), make_spike(ms(1.1) + 1, 0)};
  EXPECT_EQ(plain(run(parse(relay("0.1 ms", "1 ms")), input, 5 * kMs)),
            (Pairs{{ms(1.1), 0}, {ms(2.0), 0}, {ms(2.1), 0}, {ms(2.1), 0}, {ms(2.2), 0}}));
}

TEST(Repeater, RepeatsAtExactTimesWithoutAGrid) {
  const Spikes input = {make_spike(1, 0), make_spike(ms(1.05), 0), make_spike(ms(1.05), 0),
                        make_spike(ms(1.1) + 7, 0)};
  EXPECT_EQ(plain(run(parse(relay("off", "0.35 ms")), input, 5 * kMs)),
            (Pairs{{350'001, 0}, {ms(1.4), 0}, {ms(1.4), 0}, {ms(1.45) + 7, 0}}));
}

TEST(Repeater, LosesAndAddsNothingAtAnyTick) {
  constexpr int kChannels = 100;
  std::mt19937_64 random(7);
  std::uniform_int_distribution<TimeNs> time(1, 400 * kMs);
  std::uniform_int_distribution<int> channel(0, kChannels - 1);
  Spikes input;
  for (int i = 0; i < 5000; ++i) {
    input.push_back(make_spike(time(random), channel(random)));
  }
  for (const TimeNs grid : {TimeNs{0}, 100 * TimeNs{1'000}, kMs}) {
    Spikes wanted;
    for (const Spike& s : input) {
      const TimeNs on_grid = grid == 0 ? s.time_ns : (s.time_ns + grid - 1) / grid * grid;
      wanted.push_back(make_spike(on_grid + 3 * kMs, s.channel));
    }
    std::sort(wanted.begin(), wanted.end(), spike_before);
    const NetworkFile network =
        parse(relay(grid == 0 ? "off" : format_time(grid), "3 ms", kChannels));
    for (const TimeNs tick : {1 * kMs, 10 * kMs, 50 * kMs}) {
      EXPECT_EQ(plain(run(network, input, 450 * kMs, tick)), plain(wanted));
    }
  }
}

TEST(Repeater, KeepsMultiplicityThroughChainsAndForks) {
  for (const char* resolution : {"0.1 ms", "off"}) {
    const NetworkFile network = parse(
        fmt::format("resolution: {}\n"
                    "populations:\n"
                    "  input: {{model: input, size: 1}}\n"
                    "  fork: {{model: repeater, size: 2}}\n"
                    "  join: {{model: repeater, size: 1}}\n"
                    "connections:\n"
                    "  - {{from: input, to: fork, rule: all_to_all, weight: 1, delay: 1 ms}}\n"
                    "  - {{from: fork, to: join, rule: all_to_all, weight: 1, delay: 2 ms}}\n"
                    "output: [join]\n",
                    resolution));
    const Spikes input(3, make_spike(5 * kMs, 0));
    EXPECT_EQ(plain(run(network, input, 20 * kMs)), Pairs(6, {8 * kMs, 0})) << resolution;
  }
}

TEST(Repeater, ASpikeRunsRoundALoopForEver) {
  for (const char* resolution : {"0.1 ms", "off"}) {
    const NetworkFile network = parse(
        fmt::format("resolution: {}\n"
                    "populations:\n"
                    "  input: {{model: input, size: 1}}\n"
                    "  ring: {{model: repeater, size: 3}}\n"
                    "connections:\n"
                    "  - {{from: input, to: ring, rule: pairs, pairs: [[0, 0]], delay: 1 ms}}\n"
                    "  - {{from: ring, to: ring, rule: pairs, pairs: [[0, 1], [1, 2], [2, 0]], "
                    "delay: 0.3 ms}}\n"
                    "output: [ring]\n",
                    resolution));
    const Spikes spikes = run(network, {make_spike(kMs, 0)}, 62 * kMs, 2 * kMs);
    ASSERT_EQ(spikes.size(), 201u);
    for (int k = 0; k <= 200; ++k) {
      EXPECT_EQ(spikes[k].time_ns, 2 * kMs + k * 300'000);
      EXPECT_EQ(spikes[k].channel, k % 3);
    }
  }
}

TEST(Delay, LongerThanTheTickShorterThanTheTickAndDifferentPerConnection) {
  const NetworkFile network = parse(
      "resolution: 0.1 ms\n"
      "populations:\n"
      "  input: {model: input, size: 1}\n"
      "  relay: {model: repeater, size: 3}\n"
      "connections:\n"
      "  - {from: input, to: relay, rule: pairs, pairs: [[0, 0]], delay: 0.1 ms}\n"
      "  - {from: input, to: relay, rule: pairs, pairs: [[0, 1]], delay: 7.5 ms}\n"
      "  - {from: input, to: relay, rule: pairs, pairs: [[0, 2]], delay: 0.12 s}\n"
      "output: [relay]\n");
  for (const TimeNs tick : {kMs, 50 * kMs}) {
    EXPECT_EQ(plain(run(network, {make_spike(ms(2.3), 0)}, 150 * kMs, tick)),
              (Pairs{{ms(2.4), 0}, {ms(9.8), 1}, {ms(122.3), 2}}));
  }
}

TEST(Weights, MultiplicityAddsUpInANeuron) {
  const auto network = [](double weight) {
    return parse(
        fmt::format("populations:\n"
                    "  input: {{model: input, size: 1}}\n"
                    "  cell: {{model: iaf_psc_delta, size: 1}}\n"
                    "connections:\n"
                    "  - {{from: input, to: cell, rule: one_to_one, weight: {} mV, delay: 1 ms}}\n"
                    "output: [cell]\n",
                    weight));
  };
  const Spikes three(3, make_spike(4 * kMs, 0));
  EXPECT_EQ(plain(run(network(5.0), three, 10 * kMs)), (Pairs{{5 * kMs, 0}}));
  EXPECT_TRUE(run(network(4.999), three, 10 * kMs).empty());
}

TEST(Refractory, ADeltaNeuronIgnoresSpikesUntilItsEnd) {
  // Fires at 5 ms; refractory (5 ms, 7 ms]: what acts at 7 ms is lost, what acts at 7.1 ms is not.
  const NetworkFile network = parse(
      "populations:\n"
      "  input: {model: input, size: 1}\n"
      "  cell: {model: iaf_psc_delta, size: 1, parameters: {t_ref: 2 ms}}\n"
      "connections:\n"
      "  - {from: input, to: cell, rule: one_to_one, weight: 20 mV, delay: 1 ms}\n"
      "output: [cell]\n");
  const auto second = [&](double time) {
    return plain(run(network, {make_spike(4 * kMs, 0), make_spike(ms(time), 0)}, 20 * kMs));
  };
  EXPECT_EQ(second(5.0), (Pairs{{5 * kMs, 0}}));
  EXPECT_EQ(second(6.0), (Pairs{{5 * kMs, 0}}));
  EXPECT_EQ(second(6.1), (Pairs{{5 * kMs, 0}, {ms(7.1), 0}}));
}

TEST(Refractory, IsRoundedUpToTheGrid) {
  const NetworkFile network = parse(
      "populations:\n"
      "  input: {model: input, size: 1}\n"
      "  cell: {model: iaf_psc_delta, size: 1, parameters: {t_ref: 2.01 ms}}\n"
      "connections:\n"
      "  - {from: input, to: cell, rule: one_to_one, weight: 20 mV, delay: 1 ms}\n"
      "output: [cell]\n");
  const Spikes input = {make_spike(4 * kMs, 0), make_spike(ms(6.1), 0), make_spike(ms(6.2), 0)};
  EXPECT_EQ(plain(run(network, input, 20 * kMs)), (Pairs{{5 * kMs, 0}, {ms(7.2), 0}}));
}

TEST(LateSpike, KeepsItsTimeWhileTheDelayCoversItAndIsCounted) {
  for (const char* resolution : {"0.1 ms", "off"}) {
    Runner runner(parse(relay(resolution, "2 ms")), kMs);
    for (int k = 0; k < 10; ++k) {
      runner.step({});
    }
    // (10 ms, 11 ms]: stamped on the border, and before it.
    EXPECT_TRUE(runner.step({make_spike(10 * kMs, 0), make_spike(ms(9.5), 0)}).size() == 0);
    EXPECT_EQ(plain(runner.step({})), (Pairs{{ms(11.5), 0}, {12 * kMs, 0}}));
    EXPECT_EQ(runner.counter("late_spikes"), 2u);
    EXPECT_EQ(runner.counter("spikes"), 2u);
  }
}

TEST(LateSpike, ActsAtTheFirstStepWhenItsTimeHasPassed) {
  const Spikes late = {make_spike(ms(3.1), 0), make_spike(ms(-1.2), 0), make_spike(ms(10.4), 0)};
  for (const auto& [resolution, first] :
       {std::pair{"0.1 ms", ms(10.1)}, std::pair{"off", 10 * kMs + 1}}) {
    Runner runner(parse(relay(resolution, "0.5 ms")), kMs);
    for (int k = 0; k < 10; ++k) {
      runner.step({});
    }
    EXPECT_EQ(plain(runner.step(late)), (Pairs{{first, 0}, {first, 0}, {ms(10.9), 0}}));
    EXPECT_EQ(runner.counter("late_spikes"), 2u);
  }
}

TEST(Ports, InputsAreInTheFilesOrderAndOutputsInThatOfTheList) {
  const NetworkFile network = parse(
      "populations:\n"
      "  left: {model: input, size: 2}\n"
      "  a: {model: repeater, size: 2}\n"
      "  right: {model: input, size: 1}\n"
      "  b: {model: repeater, size: 1}\n"
      "connections:\n"
      "  - {from: left, to: a, rule: one_to_one, delay: 1 ms}\n"
      "  - {from: right, to: b, rule: one_to_one, delay: 1 ms}\n"
      "output: [b, a]\n");
  EXPECT_EQ(network.input_width(), 3u);
  EXPECT_EQ(network.output_width(), 3u);
  const Spikes input = {make_spike(1 * kMs, 0), make_spike(2 * kMs, 1), make_spike(3 * kMs, 2)};
  EXPECT_EQ(plain(run(network, input, 10 * kMs)),
            (Pairs{{2 * kMs, 1}, {3 * kMs, 2}, {4 * kMs, 0}}));
}

TEST(Tick, MustBeAWholeNumberOfResolutions) {
  const NetworkFile network = parse(relay("0.3 ms", "0.3 ms"));
  Runner runner(network, kMs);
  try {
    runner.step({});
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), Fault("net.yaml:1:13: the tick 1 ms ... network's resolution 300 us "
                                    "... 900 us ... [SL0207]"));
  }
  EXPECT_NO_THROW(network.check_tick(ms(0.9)));
  EXPECT_NO_THROW(parse(relay("off", "0.3 ms")).check_tick(12'345));
}

class NetworkClass : public testing::Test {
 protected:
  NodeSetup setup(const std::string& text, std::vector<std::uint32_t> widths) {
    path_ = (directory_.path() / "brain.yaml").string();
    std::ofstream(path_) << text;
    NodeSetup s;
    s.name = "brain";
    s.parameters.set("network", path_);
    s.widths = std::move(widths);
    return s;
  }
  std::string refusal(const std::string& text, std::vector<std::uint32_t> widths) {
    try {
      network_class().create(setup(text, std::move(widths)));
    } catch (const ConfigurationError& error) {
      return error.what();
    }
    return "";
  }
  TemporaryDirectory directory_;
  std::string path_;
};

TEST_F(NetworkClass, IsRegisteredAndReadsItsFile) {
  Registry registry;
  register_neurons(registry);
  const NodeClass& node_class = registry.find("network");
  EXPECT_EQ(node_class.description.ports.at(0).name, "in");
  EXPECT_EQ(node_class.description.ports.at(1).name, "out");
  EXPECT_NE(node_class.create(setup(relay("1 ms", "1 ms", 5), {5, 5, 0, 0, 0})), nullptr);
  EXPECT_NE(node_class.create(setup(relay("1 ms", "1 ms", 5), {5, 0, 0, 0, 0})), nullptr)
      << "an output nobody listens to has no width";
}

TEST_F(NetworkClass, RefusesOtherWidths) {
  const std::string in = refusal(relay("1 ms", "1 ms", 5), {4, 5, 0, 0, 0});
  EXPECT_EQ(in, path_ +
                    ": port 'in' has 4 channels, but the input populations have 5 together; "
                    "write the same number in the connection and in the network file [SL0306]");
  const std::string out = refusal(relay("1 ms", "1 ms", 5), {5, 6, 0, 0, 0});
  EXPECT_THAT(out, Fault(path_ + ": port 'out' has 6 channels, but the populations of 'output' "
                                 "have 5 together ... [SL0306]"));
  const std::string one = "populations:\n  a: {model: lin_rate_ipn, size: 2}\nrates: [a]\n";
  EXPECT_EQ(refusal(one, {0, 0, 0, 0, 2}), "");
  EXPECT_THAT(refusal(one, {0, 0, 0, 0, 3}),
              Fault(path_ + ": port 'rates' has 3 channels, but the populations of 'rates' have 2 "
                            "together ... [SL0306]"));
}

TEST_F(NetworkClass, NamesAFileThatIsNotThere) {
  NodeSetup s;
  s.parameters.set("network", std::string("/nowhere/brain.yaml"));
  try {
    network_class().create(s);
    FAIL();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("/nowhere/brain.yaml"));
    EXPECT_THAT(error.what(), Fault("... [SL0109]"));
  }
}

}  // namespace
}  // namespace spikeloop::test
