// Inputs that take parts of outputs, or several outputs, against values written by hand.
#include <gmock/gmock.h>

#include "spikeloop/core/graph.hpp"
#include "support.hpp"

namespace spikeloop::test {
namespace combined_inputs {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr TimeNs kMs = 1'000'000;
using Values = std::vector<double>;
using SomeSource = std::unique_ptr<FunctionSource>;

/// In tick n, from `first` on: channel c has the value 10 * scale * c + n.
SomeSource ramp(std::uint32_t width, double scale, int first = 0) {
  return std::make_unique<FunctionSource>(PortKind::signal, width,
                                          [=, tick = 0](const Step& step) mutable {
                                            const SignalOutput output = step.signal_output();
                                            for (std::uint32_t c = 0; c < width; ++c) {
                                              output.values()[c] = 10 * scale * c + tick;
                                            }
                                            if (tick++ >= first) {
                                              output.commit();
                                            }
                                          });
}

/// Each channel c has a spike at `at` ns, and channel 0 a second one a nanosecond later.
SomeSource volley(std::uint32_t width, TimeNs at) {
  return std::make_unique<FunctionSource>(PortKind::spikes, width, [=](const Step& step) {
    const TimeNs begin = step.interval().begin;
    for (std::uint32_t c = 0; c < width; ++c) {
      step.spike_output().emit(begin + at, static_cast<std::int32_t>(c));
    }
    step.spike_output().emit(begin + at + 1, 0);
  });
}

class CombinedInputs : public testing::Test {
 protected:
  CombinedInputs() { graph_.tick = kMs; }

  void add(const char* name, SomeSource source) {
    sources_.push_back(std::move(source));
    graph_.sources.push_back({name, sources_.back().get()});
  }
  void connect(const char* from, ChannelRange channels = {},
               Combination combination = Combination::alone, std::uint32_t delay = 0) {
    graph_.connections.push_back({.from = from,
                                  .to = "sink",
                                  .delay_ticks = delay,
                                  .channels = channels,
                                  .combination = combination});
  }
  /// What the sink reads in each tick; an empty list: no value.
  std::vector<Values> signals(std::uint32_t width, int ticks) {
    std::vector<Values> seen;
    FunctionSink sink(PortKind::signal, width, [&](const Step& step) {
      const SignalInput in = step.signal_input();
      seen.push_back(in.valid() ? Values(in.values.begin(), in.values.end()) : Values());
    });
    run(sink, ticks);
    return seen;
  }
  /// "time channel" of every spike, in the order in which the sink reads them.
  std::vector<std::string> spikes(std::uint32_t width, int ticks) {
    std::vector<std::string> seen;
    FunctionSink sink(PortKind::spikes, width, [&](const Step& step) {
      for (const Spike& spike : step.spike_input().spikes) {
        seen.push_back(std::to_string(spike.time_ns) + " " + std::to_string(spike.channel));
      }
    });
    run(sink, ticks);
    return seen;
  }
  std::string fault(std::uint32_t width, PortKind kind = PortKind::signal) {
    FunctionSink sink(kind, width, [](const Step&) {});
    return message_of<ConfigurationError>([&] { run(sink, 0); });
  }

  void run(FunctionSink& sink, int ticks) {
    graph_.sinks = {{"sink", &sink}};
    Graph graph(graph_);
    for (int i = 0; i < ticks; ++i) {
      graph.step();
    }
    reports_ = graph.connections();
  }

  std::vector<SomeSource> sources_;
  GraphDescription graph_;
  std::vector<ConnectionReport> reports_;
};

TEST_F(CombinedInputs, ASliceHasItsChannelsOnly) {
  add("a", ramp(4, 1));
  connect("a", {1, 3});
  EXPECT_THAT(signals(2, 2), ElementsAre(Values{10, 20}, Values{11, 21}));
}

TEST_F(CombinedInputs, ASliceWithoutAnEndGoesToTheLastChannel) {
  add("a", ramp(4, 1));
  connect("a", {2, 0});
  EXPECT_THAT(signals(2, 1), ElementsAre(Values{20, 30}));
}

TEST_F(CombinedInputs, AppendedSignalsStandOneAfterAnother) {
  add("a", ramp(2, 1));
  add("b", ramp(3, 100));
  connect("a");
  connect("b", {2, 3}, Combination::appended);
  connect("a", {0, 1}, Combination::appended);
  EXPECT_THAT(signals(4, 2), ElementsAre(Values{0, 10, 2000, 0}, Values{1, 11, 2001, 1}));
}

TEST_F(CombinedInputs, AddedSignalsAreSummed) {
  add("a", ramp(2, 1));
  add("b", ramp(3, 100));
  connect("a");
  connect("b", {1, 3}, Combination::added);
  EXPECT_THAT(signals(2, 2), ElementsAre(Values{1000, 2010}, Values{1002, 2012}));
}

TEST_F(CombinedInputs, ThereIsNoValueUntilEverySenderHasOne) {
  add("a", ramp(1, 1));
  add("late", ramp(1, 1, 2));
  connect("a");
  connect("late", {}, Combination::added);
  EXPECT_THAT(signals(1, 4), ElementsAre(IsEmpty(), IsEmpty(), Values{4}, Values{6}));
}

TEST_F(CombinedInputs, EachConnectionHasItsDelay) {
  add("a", ramp(1, 1));
  add("b", ramp(1, 1));
  connect("a");
  connect("b", {}, Combination::appended, 2);
  EXPECT_THAT(signals(2, 4), ElementsAre(IsEmpty(), IsEmpty(), Values{2, 0}, Values{3, 1}));
}

TEST_F(CombinedInputs, AnUnchangedInputKeepsItsRevision) {
  add("a",
      std::make_unique<FunctionSource>(PortKind::signal, 1, [tick = 0](const Step& step) mutable {
        if (tick++ % 3 == 0) {
          step.signal_output().values()[0] = tick;
          step.signal_output().commit();
        }
      }));
  connect("a");
  connect("a", {}, Combination::appended);
  std::vector<std::uint64_t> revisions;
  FunctionSink sink(PortKind::signal, 2,
                    [&](const Step& step) { revisions.push_back(step.signal_input().revision); });
  run(sink, 5);
  EXPECT_THAT(revisions, ElementsAre(1, 1, 1, 2, 2));
}

TEST_F(CombinedInputs, AppendedSpikesMoveToTheirChannelsAndStandInOrder) {
  add("a", volley(2, 700));
  add("b", volley(3, 500));
  connect("a");
  connect("b", {0, 2}, Combination::appended);
  EXPECT_THAT(spikes(4, 1), ElementsAre("500 2", "500 3", "501 2", "700 0", "700 1", "701 0"));
}

TEST_F(CombinedInputs, AddedSpikesAreMerged) {
  add("a", volley(2, 500));
  add("b", volley(2, 501));
  connect("a");
  connect("b", {}, Combination::added, 1);
  EXPECT_THAT(spikes(2, 2), ElementsAre("500 0", "500 1", "501 0",  //
                                        "1000500 0", "1000500 1", "1000501 0", "1000501 0",
                                        "1000501 1", "1000502 0"));
}

TEST_F(CombinedInputs, TheReportCountsTheSpikesOfTheSlice) {
  add("a", volley(3, 500));
  connect("a", {1, 3});
  spikes(2, 10);
  EXPECT_EQ(reports_.front().spikes, 20U);
  EXPECT_EQ(reports_.front().sent, 40U);
}

TEST_F(CombinedInputs, ChannelsThatTheSenderDoesNotHave) {
  add("a", ramp(4, 1));
  connect("a", {2, 5});
  EXPECT_EQ(fault(3),
            "'a.out' has 4 channels, counted from 0, and [2:5] is not within them; write for "
            "example  [0:4] [SL0203]");
  graph_.connections.front().channels = {4, 0};
  EXPECT_THAT(fault(3), HasSubstr("and [4:] is not within them"));
}

TEST_F(CombinedInputs, WidthsThatDoNotAddUp) {
  add("a", ramp(4, 1));
  add("b", ramp(2, 1));
  connect("a", {0, 3});
  connect("b", {}, Combination::appended);
  EXPECT_EQ(fault(6),
            "widths differ: 'a.out[0:3], b.out' has 5 channels, 'sink.in' has 6 [SL0306]");
  graph_.connections.back().combination = Combination::added;
  EXPECT_EQ(fault(3), "widths differ: 'b.out' has 2 channels, 'sink.in' has 3 [SL0306]");
}

/// Its output is as wide as its connection says.
NodeClass source_class() {
  return function_class({port("out", PortKind::signal, Direction::output)}, [](const Step&) {});
}

TEST_F(CombinedInputs, OneUnknownSenderHasTheOtherChannels) {
  const NodeClass source = source_class();
  graph_.nodes = {{"open", &source, {}, {}}};
  add("b", ramp(2, 1));
  connect("open");
  connect("b", {}, Combination::appended);
  EXPECT_THAT(signals(6, 1), ElementsAre(IsEmpty())) << "'open' has four channels and no value";
  graph_.connections.front().channels = {0, 4};
  EXPECT_EQ(fault(6),
            "the width of 'open.out' is unknown; write it in a connection of all its channels:  "
            "open.out -> NODE [10] [SL0307]");
  graph_.connections.front().channels = {2, 0};
  EXPECT_THAT(fault(6), HasSubstr("the width of 'open.out' is unknown"));
  graph_.connections.front().channels = {0, 4};
  graph_.connections.front().sender_width = 9;
  EXPECT_THAT(signals(6, 1), ElementsAre(IsEmpty()));
  graph_.connections = {};
  connect("b");
  connect("open", {}, Combination::added);
  EXPECT_THAT(signals(2, 1), ElementsAre(IsEmpty())) << "all senders of a sum are as wide";
}

TEST(ChannelRange, IsWrittenAsInPython) {
  EXPECT_EQ(ChannelRange().text(), "");
  EXPECT_EQ((ChannelRange{0, 50}).text(), "[0:50]");
  EXPECT_EQ((ChannelRange{7, 8}).text(), "[7]");
  EXPECT_EQ((ChannelRange{7, 0}).text(), "[7:]");
}

}  // namespace combined_inputs
}  // namespace spikeloop::test
