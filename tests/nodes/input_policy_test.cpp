#include <cmath>
#include <limits>

#include "harness.hpp"

namespace spikeloop::testing {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
const double kNan = std::nan("");

// Regular spikes tell which value each channel is held to have: 1 kHz * (x + 1) / 2 over 1 s.
std::vector<double> values_seen(NodeHarness& node, std::size_t channels) {
  const std::size_t before = node.spike_count();
  const TimeNs begin = node.time();
  node.run_until(begin + 10 * kNsPerSecond, 10 * kMs);
  std::vector<double> values(channels, -1.0);
  for (const Spike& spike : node.spikes()) {
    if (spike.time_ns > begin) {
      values[static_cast<std::size_t>(spike.channel)] += 2.0 / 10'000;
    }
  }
  EXPECT_GE(node.spike_count(), before);
  return values;
}

NodeHarness encoder(std::map<std::string, std::string> keys, std::uint32_t channels) {
  keys["rate_max"] = "1 kHz";
  return NodeHarness("rate_encoder", {channels, channels}, {.keys = std::move(keys)});
}

void expect_values(const std::vector<double>& seen, const std::vector<double>& wanted) {
  ASSERT_EQ(seen.size(), wanted.size());
  for (std::size_t c = 0; c < seen.size(); ++c) {
    EXPECT_NEAR(seen[c], wanted[c], 5e-4) << "channel " << c;
  }
}

TEST(InputPolicy, ClipsByDefaultInfinitiesToo) {
  NodeHarness node = encoder({}, 6);
  node.set_input({1.5, -1.5, kInf, -kInf, 0.5, 1.0});
  expect_values(values_seen(node, 6), {1, -1, 1, -1, 0.5, 1});
  EXPECT_EQ(node.counter("inputs_clipped"), 4U) << "once a revision and channel";
  EXPECT_EQ(node.counter("inputs_not_finite"), 0U);
  EXPECT_EQ(node.counter("rates_limited"), 0U);
  node.set_input({2.0, 0.0, 0.0, 0.0, 0.0, 0.0});
  node.step(kMs);
  EXPECT_EQ(node.counter("inputs_clipped"), 5U);
}

TEST(InputPolicy, HoldsTheLastValueForNanByDefault) {
  NodeHarness node = encoder({}, 3);
  node.set_input({0.5, kNan, 7.0});
  expect_values(values_seen(node, 3), {0.5, -1, 1});  // no value yet: silent
  node.set_input({kNan, 0.25, kNan});
  expect_values(values_seen(node, 3), {0.5, 0.25, 1});
  EXPECT_EQ(node.counter("inputs_not_finite"), 3U);
  EXPECT_EQ(node.counter("inputs_clipped"), 1U);
}

TEST(InputPolicy, ZeroTakesTheMiddleOfTheRange) {
  NodeHarness node = encoder({{"not_finite", "zero"}}, 2);
  node.set_input({0.5, kNan});
  expect_values(values_seen(node, 2), {0.5, 0});
  EXPECT_EQ(node.counter("inputs_not_finite"), 1U);
}

TEST(InputPolicy, PassTreatsInfinitiesAsNotFinite) {
  NodeHarness node = encoder({{"out_of_range", "pass"}}, 3);
  node.set_input({1.5, -0.5, 0.5});
  expect_values(values_seen(node, 3), {1.5, -0.5, 0.5});
  node.set_input({kInf, -kInf, kNan});
  expect_values(values_seen(node, 3), {1.5, -0.5, 0.5});
  EXPECT_EQ(node.counter("inputs_not_finite"), 3U);
  EXPECT_EQ(node.counter("inputs_clipped"), 0U);
}

TEST(InputPolicy, ErrorsNameChannelAndValue) {
  const auto failure = [](const std::string& key, double value, const char* node_class) {
    NodeHarness node(node_class, {3, 3}, {.keys = {{key, "error"}}});
    node.set_input({0.0, 1.0, value});
    return message_of([&] { node.step(kMs); });
  };
  for (const char* node_class : {"rate_encoder", "poisson_encoder"}) {
    EXPECT_EQ(failure("out_of_range", 1.25, node_class),
              "input channel 2 has the value 1.25, outside [-1, 1]; scale the signal before this "
              "node, or write out_of_range = clip");
    EXPECT_EQ(failure("out_of_range", -kInf, node_class),
              "input channel 2 has the value -inf, outside [-1, 1]; scale the signal before this "
              "node, or write out_of_range = clip");
    EXPECT_EQ(
        failure("not_finite", kNan, node_class),
        "input channel 2 has the value nan, which is not a number to work with; mend its source, "
        "or write not_finite = hold");
  }
}

TEST(InputPolicy, PoliciesAreChoices) {
  EXPECT_THAT(
      message_of([] {
        encoder({{"out_of_range", "clamp"}}, 1);
      }),
      Fault("test.yaml:7:3: key 'out_of_range': 'clamp' ... clip, pass, error ... [SL0205]"));
  EXPECT_EQ(message_of([] {
              NodeHarness("connect", {1, 1}, {.keys = {{"out_of_range", "clip"}}});
            }),
            "test.yaml:7:3: unknown key 'out_of_range'; known: weights, not_finite [SL0103]");
}

TEST(EncoderParameters, InitialIsANumberInRangeOrNone) {
  const auto failure = [](const std::string& text) {
    return message_of([&] { encoder({{"initial", text}}, 1); });
  };
  EXPECT_THAT(failure("low"), Fault("test.yaml:7:3: key 'initial': 'low' ... 'none' ... -1 to 1, "
                                    "or none for silence until the first input ... [SL0201]"));
  EXPECT_THAT(failure("nan"),
              Fault("test.yaml:7:3: key 'initial': 'nan' ... 'none' ... -1 to 1 ... [SL0201]"));
  EXPECT_THAT(failure("-1.5"),
              Fault("test.yaml:7:3: key 'initial': -1.5 ... -1 to 1 ... [SL0203]"));
  NodeHarness beyond = encoder({{"initial", "1.5"}, {"out_of_range", "pass"}}, 1);
  expect_values(values_seen(beyond, 1), {1.5});
  for (const char* text : {"none", ""}) {
    NodeHarness silent = encoder({{"initial", text}}, 1);
    expect_values(values_seen(silent, 1), {-1});
  }
}

TEST(EncoderParameters, RatesHaveBounds) {
  const auto failure = [](const std::string& key, const std::string& text) {
    return message_of([&] { NodeHarness("poisson_encoder", {1, 1}, {.keys = {{key, text}}}); });
  };
  EXPECT_THAT(failure("rate_max", "2 MHz"),
              Fault("test.yaml:7:3: key 'rate_max': 2000000 ... 0 to 1000000 Hz ... [SL0203]"));
  EXPECT_THAT(failure("rate_min", "-1"),
              Fault("test.yaml:7:3: key 'rate_min': -1 ... 0 to 1000000 Hz ... [SL0203]"));
}

TEST(Register, ClassesHaveTextsForTheReference) {
  Registry registry;
  register_nodes(registry);
  EXPECT_EQ(registry.names(), (std::vector<std::string>{"argmax",
                                                        "clip",
                                                        "connect",
                                                        "delay",
                                                        "discretize",
                                                        "disturb_signal",
                                                        "disturb_spikes",
                                                        "function",
                                                        "linear_readout",
                                                        "low_pass",
                                                        "nef_encoder",
                                                        "normalise",
                                                        "poisson_encoder",
                                                        "population_encoder",
                                                        "population_vector",
                                                        "rate_encoder",
                                                        "rate_window",
                                                        "sigmoid",
                                                        "step_forward_encoder",
                                                        "temporal_contrast_encoder",
                                                        "threshold",
                                                        "time_to_first_spike_encoder",
                                                        "winner_take_all"}));
  for (const std::string& name : registry.names()) {
    const NodeDescription& description = registry.find(name).description;
    EXPECT_FALSE(description.text.empty());
    EXPECT_FALSE(description.source.empty());
    for (const auto& port : description.ports) {
      EXPECT_FALSE(port.text.empty()) << name << "." << port.name;
    }
    for (const auto& parameter : description.parameters) {
      EXPECT_FALSE(parameter.text.empty()) << name << ": " << parameter.name;
      EXPECT_FALSE(parameter.text.ends_with('.')) << name << ": " << parameter.name;
    }
  }
}

TEST(InputPolicy, HoldsThoughTheRateStaysTheSame) {
  // With rate_min = 0 the rate of -1.5 is that of a channel that has no value yet.
  NodeHarness clips("rate_encoder", {1, 1});
  clips.set_input({-1.5});
  clips.step(kMs);
  EXPECT_EQ(clips.counter("inputs_clipped"), 1U);
  NodeHarness refuses("rate_encoder", {1, 1}, {.keys = {{"out_of_range", "error"}}});
  refuses.set_input({-1.5});
  EXPECT_THROW(refuses.step(kMs), std::runtime_error);
}

}  // namespace
}  // namespace spikeloop::testing
