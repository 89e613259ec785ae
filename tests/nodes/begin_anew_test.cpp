// Nodes that begin anew: after Graph::reset() every built-in class puts out, bit for bit, what a
// node puts out that has just been made and gets the same input.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "spikeloop/core/graph.hpp"
#include "spikeloop/core/random.hpp"
#include "tests/core/support.hpp"
#include "tests/nodes/harness.hpp"

namespace spikeloop::begin_anew_test {
namespace {

using test::FunctionSink;
using test::FunctionSource;
using testing::kMs;

constexpr std::uint64_t kSeed = 7;
constexpr int kTicks = 200;    // of an episode
constexpr int kBefore = 1237;  // ticks before the reset
constexpr std::uint32_t kInputs = 4;

struct Case {
  std::string name;
  std::map<std::string, std::string> keys{};
  std::uint32_t outputs = kInputs;
  std::uint32_t delay = 0;
  unsigned threads = 1;
  std::string label{};
};

void PrintTo(const Case& each, std::ostream* out) {
  *out << each.label;
}

// What a node put out during a tick that began that long after the begin.
struct Row {
  TimeNs begin = 0;
  bool valid = false;
  std::vector<double> values{};
  std::vector<std::pair<TimeNs, int>> spikes{};
  bool operator==(const Row&) const = default;
};

struct Recorded {
  std::vector<Row> rows;
  std::vector<std::uint64_t> revisions;
  std::map<std::string, std::uint64_t> counters;
};

// Another input in the time before the begin than after it, the same after every begin.
double input_value(std::int64_t tick, std::uint32_t channel) {
  return tick < 0 ? 0.9 * std::sin(0.7 * static_cast<double>(tick + 5 * channel))
                  : 0.8 * std::cos(0.013 * static_cast<double>(tick / 10 + 40 * channel));
}

// Runs a node of the class for `before` ticks, resets it, and runs it for an episode.
Recorded run(const Case& each, std::uint64_t seed, int before) {
  const NodeClass node_class = testing::built_in(each.name);
  const auto& ports = node_class.description.ports;
  std::int64_t tick = -before;
  FunctionSource signal(PortKind::signal, kInputs, [&](const Step& step) {
    const auto output = step.signal_output();
    for (std::uint32_t c = 0; c < kInputs; ++c) {
      output.values()[c] = input_value(tick, c);
    }
    if (tick < 0 || tick % 10 == 0) {
      output.commit();
    }
  });
  FunctionSource spikes(PortKind::spikes, kInputs, [&](const Step& step) {
    for (std::uint32_t c = 0; c < kInputs; ++c) {
      if ((tick + 7 * c) % (tick < 0 ? 3 : 11) == 0 || tick % (5 + c) == 2) {
        step.spike_output().emit(step.interval().begin + 1 + 1000 * c, static_cast<int>(c));
      }
    }
  });
  Recorded recorded;
  const auto record = [&](const Step& step, bool continuous) {
    if (continuous) {
      recorded.revisions.push_back(step.signal_input().revision);
    }
    if (tick < 0) {
      return;
    }
    const TimeNs origin = before * kMs;
    Row row{step.interval().begin - origin};
    if (continuous && step.signal_input().valid()) {
      row.valid = true;
      row.values.assign(step.signal_input().values.begin(), step.signal_input().values.end());
    } else if (!continuous) {
      for (const Spike& spike : step.spike_input().spikes) {
        row.spikes.emplace_back(spike.time_ns - origin, spike.channel);
      }
    }
    recorded.rows.push_back(row);
  };
  const bool takes_spikes = ports.at(0).kind == PortKind::spikes;
  const bool gives_signal = ports.at(1).kind == PortKind::signal;
  FunctionSink sink(ports.at(1).kind, each.outputs,
                    [&](const Step& step) { record(step, gives_signal); });
  WrittenValues written;
  for (const auto& [key, value] : each.keys) {
    written[key] = {value, {}};
  }
  const WeightLoader weights = [](const WrittenValue& value) {
    return value.text == "even" ? WeightTable::even() : WeightTable::uniform();
  };
  GraphDescription description;
  description.tick = kMs;
  description.seed = seed;
  description.nodes = {{.name = "node",
                        .node_class = &node_class,
                        .parameters = resolve(node_class.description.parameters, written, weights),
                        .threads = each.threads,
                        .begins_anew = true}};
  description.sources = {{"source", takes_spikes ? static_cast<Source*>(&spikes) : &signal}};
  description.sinks = {{"sink", &sink}};
  description.connections = {
      {.from = "source", .to = "node", .width = kInputs, .delay_ticks = each.delay},
      {.from = "node", .to = "sink", .width = each.outputs, .delay_ticks = each.delay}};
  Graph graph(description);
  for (; tick < 0; ++tick) {
    graph.step();
  }
  if (before > 0) {
    graph.reset("node");
  }
  for (; tick < kTicks; ++tick) {
    graph.step();
  }
  for (const Counter& counter : graph.counters()) {
    recorded.counters[counter.name] = counter.value;
  }
  return recorded;
}

class BeginAnew : public ::testing::TestWithParam<Case> {};

TEST_P(BeginAnew, PutsOutWhatANewNodePutsOut) {
  const Recorded anew = run(GetParam(), kSeed, kBefore);
  // The noise of the second episode is that of a run with the seed of the second episode.
  const bool noisy = GetParam().label.ends_with("noise");
  const Recorded fresh = run(GetParam(), noisy ? episode_seed(kSeed, 2) : kSeed, 0);
  ASSERT_EQ(anew.rows.size(), fresh.rows.size());
  bool something = false;
  for (std::size_t i = 0; i < fresh.rows.size(); ++i) {
    ASSERT_EQ(anew.rows[i], fresh.rows[i]) << "tick " << i;
    something |= fresh.rows[i].valid || !fresh.rows[i].spikes.empty();
  }
  EXPECT_TRUE(something);
  for (std::size_t i = kBefore + 1; i < anew.revisions.size(); ++i) {
    if (anew.revisions[i] != 0) {
      EXPECT_GE(anew.revisions[i], anew.revisions[kBefore - 1]) << "a reader would miss it";
    }
  }
  for (const auto& [name, value] : fresh.counters) {
    EXPECT_GE(anew.counters.at(name), value) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Classes, BeginAnew,
    ::testing::Values(
        Case{"rate_encoder", {{"rate_max", "90 Hz"}}, kInputs, 0, 1, "rate_encoder"},
        Case{"rate_encoder", {{"initial_phase", "random"}}, kInputs, 0, 2, "phase_in_two_threads"},
        Case{"rate_encoder", {{"initial", "0.3"}}, kInputs, 3, 1, "rate_encoder_behind_a_delay"},
        Case{"poisson_encoder", {{"rate_max", "900 Hz"}}, kInputs, 0, 1, "poisson_noise"},
        Case{"population_encoder", {}, 3 * kInputs, 0, 1, "population_encoder"},
        Case{"nef_encoder", {}, 20, 0, 1, "nef_encoder"},
        Case{"nef_encoder", {{"preset", "rma"}}, 20, 0, 1, "nef_encoder_rma"},
        Case{"step_forward_encoder", {{"min_interval", "7 ms"}}, 2 * kInputs, 0, 1, "step_forward"},
        Case{"temporal_contrast_encoder", {{"threshold", "0.01"}}, 2 * kInputs, 0, 1, "contrast"},
        Case{"time_to_first_spike_encoder", {{"period", "70 ms"}}, kInputs, 0, 1, "first_spike"},
        Case{"low_pass", {{"tau", "37 ms"}}, kInputs, 0, 1, "low_pass"},
        Case{"low_pass", {{"tau", "37 ms"}}, kInputs, 2, 1, "low_pass_behind_a_delay"},
        Case{"delay", {{"delay", "15 ms"}}, kInputs, 0, 1, "delay"},
        Case{"function", {{"function", "x0 > 0.5 ? x1 : sqrt(-1); x2"}}, 2, 0, 1, "function"},
        Case{"argmax", {}, 1, 0, 1, "argmax"},
        Case{"linear_readout",
             {{"tau", "21 ms"}, {"weights", "uniform"}},
             2,
             0,
             1,
             "linear_readout"},
        Case{"linear_readout", {{"weights", "uniform"}}, 2, 4, 1, "linear_readout_behind_a_delay"},
        Case{"rate_window", {{"window", "60 ms"}}, kInputs, 0, 1, "rate_window"},
        Case{"population_vector", {{"tau", "50 ms"}}, 2, 0, 1, "population_vector"},
        Case{"winner_take_all", {{"margin", "0.1"}}, kInputs, 0, 1, "winner_take_all"},
        Case{"disturb_signal", {{"noise", "1"}, {"drop", "0.2"}}, kInputs, 0, 1, "signal_noise"},
        Case{"disturb_spikes", {{"drop", "0.3"}, {"jitter", "9 ms"}}, kInputs, 0, 1, "spike_noise"},
        Case{"disturb_spikes", {{"lesion", "0.5"}, {"from", "50 ms"}}, kInputs, 0, 1, "lesion"}),
    [](const auto& test) { return test.param.label; });

// The noise of an episode is not that of another one.
TEST(BeginAnewWithNoise, DiffersFromTheEpisodeBefore) {
  const Case poisson{"poisson_encoder", {{"rate_max", "900 Hz"}}, kInputs, 0, 1, ""};
  EXPECT_NE(run(poisson, kSeed, kBefore).rows, run(poisson, kSeed, 0).rows);
}

TEST(BeginAnewAfterAChange, KeepsTheChange) {
  const NodeClass encoder = testing::built_in("rate_encoder");
  FunctionSource one(PortKind::signal, 1, [](const Step& step) {
    step.signal_output().values()[0] = 1;
    step.signal_output().commit();
  });
  std::size_t spikes = 0;
  FunctionSink sink(PortKind::spikes, 1,
                    [&](const Step& step) { spikes += step.spike_input().spikes.size(); });
  GraphDescription description;
  description.tick = kMs;
  description.nodes = {{.name = "node",
                        .node_class = &encoder,
                        .parameters = resolve(encoder.description.parameters, {}, {}),
                        .begins_anew = true}};
  description.sources = {{"source", &one}};
  description.sinks = {{"sink", &sink}};
  description.connections = {{"source", "node", 1}, {"node", "sink", 1}};
  Graph graph(description);
  graph.change("node", "rate_max", 500);
  graph.step();
  graph.reset("node");
  for (int i = 0; i < 1000; ++i) {
    graph.step();
  }
  EXPECT_EQ(spikes, 500U);
}

}  // namespace
}  // namespace spikeloop::begin_anew_test
