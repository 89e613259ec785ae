#include "spikeloop/core/graph.hpp"

#include "support.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop {
namespace {

using test::Fault;
using test::function_class;
using test::FunctionSink;
using test::FunctionSource;
using test::message_of;
using test::port;

constexpr TimeNs kMs = 1'000'000;
constexpr auto kSignal = PortKind::signal;
constexpr auto kSpikes = PortKind::spikes;
constexpr auto kIn = Direction::input;
constexpr auto kOut = Direction::output;

// Adds one to its input.
NodeClass increment_class() {
  return function_class(
      {port("in", kSignal, kIn), port("out", kSignal, kOut, WidthRule::same_as(0))},
      [](const Step& step) {
        const auto in = step.signal_input();
        const auto out = step.signal_output();
        if (!in.valid()) {
          return;
        }
        for (std::size_t i = 0; i < in.values.size(); ++i) {
          out.values()[i] = in.values[i] + 1.0;
        }
        out.commit();
      });
}

NodeClass relay_class() {
  return function_class(
      {port("in", kSpikes, kIn), port("out", kSpikes, kOut, WidthRule::same_as(0))},
      [](const Step& step) {
        for (const Spike& spike : step.spike_input().spikes) {
          step.spike_output().emit(step.interval().end, spike.channel);
        }
      });
}

// Writes the tick number into every channel.
FunctionSource counting_source(std::uint32_t width) {
  return {kSignal, width, [tick = 0](const Step& step) mutable {
            for (double& value : step.signal_output().values()) {
              value = tick;
            }
            ++tick;
            step.signal_output().commit();
          }};
}

GraphDescription description(TimeNs tick = kMs) {
  GraphDescription graph;
  graph.tick = tick;
  return graph;
}

TEST(Graph, AConnectionWithoutDelayIsSeenInTheSameTickWhateverTheOrderOfListing) {
  const NodeClass increment = increment_class();
  auto source = counting_source(2);
  std::vector<double> seen;
  FunctionSink sink(kSignal, 2,
                    [&](const Step& step) { seen.push_back(step.signal_input().values[1]); });
  auto graph_description = description();
  graph_description.nodes = {{"second", &increment, {}, {}}, {"first", &increment, {}, {}}};
  graph_description.sources = {{"source", &source}};
  graph_description.sinks = {{"sink", &sink}};
  graph_description.connections = {{"second", "sink"}, {"first", "second"}, {"source", "first"}};
  Graph graph(graph_description);
  for (int i = 0; i < 3; ++i) {
    graph.step();
  }
  EXPECT_EQ(seen, (std::vector<double>{2, 3, 4}));
  EXPECT_EQ(graph.time(), 3 * kMs);
}

TEST(Graph, ASignalIsInvalidUntilItsDelayHasPassed) {
  auto source = counting_source(1);
  std::vector<double> seen;
  FunctionSink sink(kSignal, 1, [&](const Step& step) {
    seen.push_back(step.signal_input().valid() ? step.signal_input().values[0] : -1);
  });
  auto graph_description = description();
  graph_description.sources = {{"source", &source}};
  graph_description.sinks = {{"sink", &sink}};
  graph_description.connections = {{"source", "sink", 1, 2, {}}};
  Graph graph(graph_description);
  for (int i = 0; i < 5; ++i) {
    graph.step();
  }
  EXPECT_EQ(seen, (std::vector<double>{-1, -1, 0, 1, 2}));
}

TEST(Graph, ARevisionTravelsUnchangedThroughADelay) {
  FunctionSource source(kSignal, 1, [tick = 0](const Step& step) mutable {
    if (tick++ == 0) {
      step.signal_output().commit();
    }
  });
  std::vector<std::uint64_t> revisions;
  FunctionSink sink(kSignal, 1,
                    [&](const Step& step) { revisions.push_back(step.signal_input().revision); });
  auto graph_description = description();
  graph_description.sources = {{"source", &source}};
  graph_description.sinks = {{"sink", &sink}};
  graph_description.connections = {{"source", "sink", 1, 1, {}}};
  Graph graph(graph_description);
  for (int i = 0; i < 4; ++i) {
    graph.step();
  }
  EXPECT_EQ(revisions, (std::vector<std::uint64_t>{0, 1, 1, 1}));
}

TEST(Graph, SpikesArriveSortedByTimeAndChannelAndADelayMovesTheirTimes) {
  FunctionSource source(kSpikes, 3, [](const Step& step) {
    const TimeNs end = step.interval().end;
    step.spike_output().emit(end, 2);
    step.spike_output().emit(end, 0);
    step.spike_output().emit(end - 5, 1);
  });
  std::vector<std::pair<TimeNs, int>> direct, delayed;
  const auto into = [](auto& list) {
    return [&list](const Step& step) {
      for (const Spike& spike : step.spike_input().spikes) {
        list.emplace_back(spike.time_ns, spike.channel);
      }
    };
  };
  FunctionSink direct_sink(kSpikes, 3, into(direct));
  FunctionSink delayed_sink(kSpikes, 3, into(delayed));
  auto graph_description = description();
  graph_description.sources = {{"source", &source}};
  graph_description.sinks = {{"direct", &direct_sink}, {"delayed", &delayed_sink}};
  graph_description.connections = {{"source", "direct"}, {"source", "delayed", 3, 2, {}}};
  Graph graph(graph_description);
  for (int i = 0; i < 3; ++i) {
    graph.step();
  }
  ASSERT_EQ(direct.size(), 9U);
  EXPECT_EQ(direct[0], std::make_pair(kMs - 5, 1));
  EXPECT_EQ(direct[1], std::make_pair(kMs, 0));
  EXPECT_EQ(direct[2], std::make_pair(kMs, 2));
  ASSERT_EQ(delayed.size(), 3U);
  EXPECT_EQ(delayed[0], std::make_pair(3 * kMs - 5, 1));
  EXPECT_EQ(delayed[2], std::make_pair(3 * kMs, 2));
  EXPECT_EQ(graph.connections()[1].late, 0U);
}

TEST(Graph, LateSpikesOfASourceArePassedOnAndCountedAndEarlyOnesHeldUntilTheirTime) {
  FunctionSource source(kSpikes, 1, [tick = 0](const Step& step) mutable {
    if (tick++ == 1) {
      step.spike_output().emit(kMs, 0);  // exactly the begin: belongs to the interval before
      step.spike_output().emit(3 * kMs + 1, 0);  // two ticks early
    }
  });
  std::vector<std::pair<TimeNs, TimeNs>> seen;
  FunctionSink sink(kSpikes, 1, [&](const Step& step) {
    for (const Spike& spike : step.spike_input().spikes) {
      seen.emplace_back(step.interval().begin, spike.time_ns);
    }
  });
  auto graph_description = description();
  graph_description.sources = {{"source", &source}};
  graph_description.sinks = {{"sink", &sink}};
  graph_description.connections = {{"source", "sink"}};
  Graph graph(graph_description);
  for (int i = 0; i < 5; ++i) {
    graph.step();
  }
  EXPECT_EQ(seen, (std::vector<std::pair<TimeNs, TimeNs>>{{kMs, kMs}, {3 * kMs, 3 * kMs + 1}}));
  EXPECT_EQ(graph.connections()[0].spikes, 2U);
  EXPECT_EQ(graph.connections()[0].late, 1U);
}

TEST(Graph, ACycleRunsWhenItsDelaysAddUpToATick) {
  // x(k) = x(k-1) + 1 through a loop of one node and a source that starts it.
  const NodeClass node = function_class(
      {port("start", kSignal, kIn), port("back", kSignal, kIn, WidthRule::same_as(0)),
       port("out", kSignal, kOut, WidthRule::same_as(0))},
      [](const Step& step) {
        const auto back = step.signal_input(1);
        step.signal_output().values()[0] =
            (back.valid() ? back.values[0] : step.signal_input(0).values[0]) + 1.0;
        step.signal_output().commit();
      });
  FunctionSource source(kSignal, 1, [](const Step& step) { step.signal_output().commit(); });
  std::vector<double> seen;
  FunctionSink sink(kSignal, 1,
                    [&](const Step& step) { seen.push_back(step.signal_input().values[0]); });
  auto graph_description = description();
  graph_description.nodes = {{"loop", &node, {}, {}}};
  graph_description.sources = {{"source", &source}};
  graph_description.sinks = {{"sink", &sink}};
  graph_description.connections = {
      {"source", "loop.start"}, {"loop", "loop.back", 0, 1, {}}, {"loop", "sink"}};
  Graph graph(graph_description);
  for (int i = 0; i < 4; ++i) {
    graph.step();
  }
  EXPECT_EQ(seen, (std::vector<double>{1, 2, 3, 4}));
}

class GraphErrors : public testing::Test {
 protected:
  GraphErrors() {
    graph_.tick = kMs;
    graph_.nodes = {{"encoder", &increment_, {}, {}}};
    graph_.sources = {{"laser", &source_}};
    graph_.sinks = {{"wheels", &sink_}};
    graph_.connections = {{"laser", "encoder", 0, 0, {"x.yaml", 3, 5}}, {"encoder", "wheels"}};
  }
  std::string message() {
    return message_of<ConfigurationError>([this] { Graph graph(graph_); });
  }

  NodeClass increment_ = increment_class();
  NodeClass relay_ = relay_class();
  FunctionSource source_ = counting_source(2);
  FunctionSink sink_{kSignal, 2, [](const Step&) {}};
  GraphDescription graph_;
};

TEST_F(GraphErrors, UnknownNode) {
  graph_.connections[0].to = "encodr.in";
  EXPECT_EQ(message(), "x.yaml:3:5: unknown node 'encodr'; did you mean 'encoder'? [SL0301]");
}

TEST_F(GraphErrors, UnknownPort) {
  graph_.connections[0].to = "encoder.inn";
  EXPECT_THAT(message(), Fault("x.yaml:3:5: 'encoder' ... 'inn' ... 'in' ... [SL0302]"));
}

TEST_F(GraphErrors, NoPortOfThatDirection) {
  graph_.connections[0].from = "wheels";
  EXPECT_THAT(message(), Fault("x.yaml:3:5: 'wheels' has no output port ... [SL0302]"));
}

TEST_F(GraphErrors, SeveralPorts) {
  increment_.description.ports[0].name = "left";
  increment_.description.ports.push_back(port("right", kSignal, kIn));
  EXPECT_EQ(message(),
            "x.yaml:3:5: 'encoder' has several input ports; write one of: encoder.left, "
            "encoder.right [SL0302]");
}

TEST_F(GraphErrors, OfSeveralPortsTheOneNamedInIsMeant) {
  increment_.description.ports.insert(increment_.description.ports.begin(),
                                      port("other", kSignal, kIn));
  increment_.description.ports.back().width = WidthRule::same_as(1);
  EXPECT_THAT(message(),
              Fault("input 'encoder.other' ... SENDER.out -> encoder.other [10] [SL0305]"));
}

TEST_F(GraphErrors, KindsDiffer) {
  graph_.nodes[0].node_class = &relay_;
  EXPECT_EQ(
      message(),
      "x.yaml:3:5: continuous output 'laser.out' cannot drive spike input 'encoder.in'; put an "
      "encoder between them [SL0303]");
}

TEST_F(GraphErrors, TwoConnectionsIntoOneInput) {
  graph_.connections.push_back({"laser", "wheels", 0, 0, {"x.yaml", 7, 1}});
  EXPECT_EQ(message(),
            "x.yaml:7:1: input 'wheels.in' has two senders, 'encoder.out' and 'laser.out'; "
            "remove one connection [SL0304]");
}

TEST_F(GraphErrors, InputWithoutConnection) {
  graph_.connections.pop_back();
  EXPECT_THAT(message(), Fault("input 'wheels.in' ... SENDER.out -> wheels.in [10] [SL0305]"));
}

TEST_F(GraphErrors, WidthsDiffer) {
  graph_.connections[0].width = 3;
  EXPECT_EQ(message(),
            "x.yaml:3:5: widths differ: 'laser.out' has 2 channels, 'encoder.in' has 3, the "
            "connection says [3] [SL0306]");
  graph_.connections[0].width = 0;
  FunctionSink narrow(kSignal, 1, [](const Step&) {});
  graph_.sinks[0].sink = &narrow;
  EXPECT_THAT(message(), Fault("port 'encoder.out' has 1 ... 2 ... 'encoder.in' ... [SL0306]"));
}

TEST_F(GraphErrors, FixedWidth) {
  increment_.description.ports[0].width = WidthRule::fixed(5);
  EXPECT_EQ(message(),
            "x.yaml:3:5: widths differ: 'laser.out' has 2 channels, 'encoder.in' has 5 [SL0306]");
}

TEST_F(GraphErrors, PortsThatMustBeAsWide) {
  FunctionSink narrow(kSignal, 1, [](const Step&) {});
  increment_.description.ports[1].width = {};
  increment_.description.ports.push_back(port("third", kSignal, kOut, WidthRule::same_as(0)));
  graph_.sinks[0].sink = &narrow;
  graph_.connections[1].from = "encoder.third";
  EXPECT_THAT(message(), Fault("port 'encoder.third' has 1 ... 2 ... 'encoder.in' ... [SL0306]"));
}

TEST_F(GraphErrors, UnknownWidth) {
  FunctionSource wide(kSignal, 0, [](const Step&) {});
  FunctionSink open(kSignal, 0, [](const Step&) {});
  graph_.sources[0].source = &wide;
  graph_.sinks[0].sink = &open;
  EXPECT_THAT(
      message(),
      Fault("x.yaml:3:5: ... 'laser.out' -> 'encoder.in' is unknown ... [10] ... [SL0307]"));
}

TEST_F(GraphErrors, TwoOfOneName) {
  graph_.sinks[0].name = "laser";
  EXPECT_EQ(message(), "two nodes are named 'laser'; give each its own name [SL0107]");
}

TEST_F(GraphErrors, CycleWithoutDelayIsNamed) {
  graph_.nodes = {{"a", &increment_, {}, {}}, {"b", &increment_, {}, {}}};
  graph_.connections = {{"a", "b"}, {"b", "a"}, {"laser", "wheels"}};
  EXPECT_THAT(message(), Fault("the cycle a -> b -> a has no delay ... 1 tick ... [SL0310]"));
}

TEST_F(GraphErrors, Tick) {
  graph_.tick = 0;
  EXPECT_EQ(message(), "a tick of 0 ns cannot be run; write for example 1 ms [SL0203]");
}

TEST_F(GraphErrors, AFactoryThatRefusesIsNamed) {
  increment_.create = [](const NodeSetup&) -> std::unique_ptr<Node> {
    throw ConfigurationError("no weights for 2 channels");
  };
  graph_.nodes[0].where = {"x.yaml", 9, 3};
  EXPECT_EQ(message(), "x.yaml:9:3: 'encoder': no weights for 2 channels");
}

std::string step_failure(const NodeClass& node_class) {
  FunctionSource source(kSpikes, 1, [](const Step&) {});
  FunctionSink sink(kSpikes, 1, [](const Step&) {});
  GraphDescription graph_description;
  graph_description.tick = kMs;
  graph_description.nodes = {{"relay", &node_class, {}, {}}};
  graph_description.sources = {{"source", &source}};
  graph_description.sinks = {{"sink", &sink}};
  graph_description.connections = {{"source", "relay"}, {"relay", "sink"}};
  Graph graph(graph_description);
  return message_of<NodeError>([&] { graph.step(); });
}

NodeClass spikes_class(std::function<void(const Step&)> function) {
  return function_class(
      {port("in", kSpikes, kIn), port("out", kSpikes, kOut, WidthRule::same_as(0))},
      std::move(function));
}

TEST(GraphStep, NamesANodeThatThrows) {
  EXPECT_EQ(step_failure(spikes_class([](const Step&) { throw std::runtime_error("broken"); })),
            "node 'relay': broken [SL0704]");
}

TEST(GraphStep, RefusesASpikeOutsideTheInterval) {
  EXPECT_EQ(step_failure(spikes_class(
                [](const Step& step) { step.spike_output().emit(step.interval().begin, 0); })),
            "node 'relay': a spike at 0 ns lies outside the interval (0, 1000000] ns [SL0704]");
}

TEST(GraphStep, RefusesAChannelOutsideThePort) {
  EXPECT_THAT(step_failure(spikes_class(
                  [](const Step& step) { step.spike_output().emit(step.interval().end, 1); })),
              Fault("node 'relay': a spike on channel 1 ... 0 to 0 ... [SL0704]"));
}

}  // namespace
}  // namespace spikeloop
