// A node whose channels several threads share: what it puts out is what one thread does, and it
// ends. ThreadSanitizer looks at the hand-over of each step (label threads).
#include "core/src/thread_team.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "tests/core/support.hpp"

namespace spikeloop::thread_team_test {
namespace {

using testing::HasSubstr;

constexpr std::uint32_t kChannels = 13;  // no multiple of a number of threads
constexpr TimeNs kTick = 1'000'000;

/// Integrates its input; the running sum is its signal, and it spikes where the sum is odd.
class Summing : public Node {
 public:
  Summing(const NodeSetup& setup, TimeNs fails_at)
      : begin_(setup.share.begin(kChannels)),
        sums_(setup.share.count(kChannels)),
        fails_at_(fails_at),
        last_(setup.share.index + 1 == setup.share.parts) {}

  void step(const Step& step) override {
    if (last_ && step.interval().begin == fails_at_) {
      throw std::runtime_error("the last part fails");
    }
    const auto values = step.signal_output().values();
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const std::size_t channel = begin_ + i;
      sums_[i] += static_cast<std::int64_t>(step.signal_input().values[channel]);
      values[channel] = static_cast<double>(sums_[i]);
      if (sums_[i] % 2 != 0) {
        step.spike_output().emit(step.interval().end, static_cast<std::int32_t>(channel));
        ++spikes_;
      }
    }
    step.signal_output().commit();
  }
  std::vector<Counter> counters() const override { return {{"spikes", spikes_}}; }

 private:
  std::uint32_t begin_;
  std::vector<std::int64_t> sums_;
  TimeNs fails_at_;
  bool last_;
  std::uint64_t spikes_ = 0;
};

NodeClass summing(TimeNs fails_at = -1) {
  NodeClass made;
  made.description.name = "summing";
  made.description.shareable = true;
  made.description.ports = {
      test::port("in", PortKind::signal, Direction::input),
      test::port("out", PortKind::signal, Direction::output, WidthRule::same_as(0)),
      test::port("spikes", PortKind::spikes, Direction::output, WidthRule::same_as(0))};
  made.create = [fails_at](const NodeSetup& setup) {
    return std::make_unique<Summing>(setup, fails_at);
  };
  return made;
}

NodeSetup setup() {
  NodeSetup made;
  made.widths = {kChannels, kChannels, kChannels};
  return made;
}

/// One node, and what it is stepped with.
class Stepped {
 public:
  explicit Stepped(unsigned threads, TimeNs fails_at = -1)
      : node_(make_node(summing(fails_at), setup(), threads)) {}

  /// Advances by a tick; the input of channel c is c + the number of the tick.
  void step() {
    for (std::size_t channel = 0; channel < kChannels; ++channel) {
      inputs_[channel] = static_cast<double>(channel) + static_cast<double>(time_ / kTick);
    }
    spikes.clear();
    const spikeloop_signal_input input{inputs_.data(), 1, kChannels, 0};
    spikeloop_signal_output signal{signals.data(), revision, kChannels, 0};
    spikeloop_spike_output spike{&spikes, &append, kChannels, 0};
    const TimeNs begin = std::exchange(time_, time_ + kTick);
    node_->step(Step({begin, time_, &input, nullptr, &signal, &spike, 1, 0, 1, 1}));
    revision = signal.revision;
    std::ranges::sort(spikes, spike_before);
  }
  std::uint64_t counted() const { return node_->counters().at(0).value; }

  std::vector<double> signals = std::vector<double>(kChannels);
  std::vector<Spike> spikes;
  std::uint64_t revision = 1;

 private:
  static void append(void* sink, const Spike* spikes, std::uint64_t count) {
    auto& list = *static_cast<std::vector<Spike>*>(sink);
    list.insert(list.end(), spikes, spikes + count);
  }

  std::unique_ptr<Node> node_;
  std::vector<double> inputs_ = std::vector<double>(kChannels);
  TimeNs time_ = 0;
};

bool same(const std::vector<Spike>& a, const std::vector<Spike>& b) {
  return std::ranges::equal(a, b, [](const Spike& x, const Spike& y) {
    return x.time_ns == y.time_ns && x.channel == y.channel;
  });
}

TEST(ThreadTeam, gives_what_one_thread_gives) {
  for (const unsigned threads : {2U, 3U, 5U}) {
    Stepped alone(1);
    Stepped team(threads);
    for (int tick = 0; tick < 400; ++tick) {
      alone.step();
      team.step();
      ASSERT_EQ(team.signals, alone.signals) << threads << " threads, tick " << tick;
      ASSERT_TRUE(same(team.spikes, alone.spikes)) << threads << " threads, tick " << tick;
      ASSERT_EQ(team.revision, alone.revision) << threads << " threads, tick " << tick;
    }
    // Of the sums of c + 0, c + 1, ... every second pair is odd, whatever c is.
    EXPECT_EQ(alone.counted(), 200U * kChannels);
    EXPECT_EQ(team.counted(), alone.counted());
  }
}

TEST(ThreadTeam, ends_without_a_step_and_after_each_number_of_steps) {
  for (int steps = 0; steps < 20; ++steps) {
    Stepped team(4);
    for (int i = 0; i < steps; ++i) {
      team.step();
    }
  }
}

TEST(ThreadTeam, passes_on_the_failure_of_a_part_and_goes_on) {
  Stepped team(4, 2 * kTick);
  team.step();
  team.step();
  EXPECT_EQ(test::message_of<std::runtime_error>([&] { team.step(); }), "the last part fails");
  const double before = team.signals.front();
  EXPECT_NE((team.step(), team.signals.front()), before);
}

TEST(ThreadTeam, needs_a_channel_for_each_part) {
  EXPECT_THAT(test::message_of<ConfigurationError>([] { make_node(summing(), setup(), 14); }),
              HasSubstr("port 'out' has 13 channels, too few for 14 parts (np times threads)"));
}

}  // namespace
}  // namespace spikeloop::thread_team_test
