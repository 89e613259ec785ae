// Python nodes while they run: what they see and what comes of what they do.
#include <chrono>
#include <cmath>
#include <thread>

#include "python_file.hpp"

namespace spikeloop::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

TEST(PythonNode, SignalsComeAndGoAndHold) {
  const PythonFile file(
      "@spikeloop.node(inputs={'in': 'signal'}, outputs={'out': spikeloop.Signal(same_as='in')},\n"
      "                name='it', gain=2.0)\n"
      "def gain(step, gain):\n"
      "    if step.changed('in'):\n"
      "        step.write('out', gain * step.inputs['in'])\n");
  NodeHarness node(file.node_class(), {3, 3}, {.keys = {{"gain", "-4"}}});
  node.step(kMs);
  EXPECT_EQ(node.revision(), 0U);
  node.set_input({1, 2, 3});
  node.step(kMs);
  EXPECT_THAT(node.output(), ElementsAre(-4, -8, -12));
  EXPECT_EQ(node.revision(), 1U);
  node.step(kMs);
  EXPECT_EQ(node.revision(), 1U) << "no work without a new value";
  node.set_input({0, 0, 1});
  node.step(kMs);
  EXPECT_THAT(node.output(), ElementsAre(0, 0, -4));
  EXPECT_EQ(node.revision(), 2U);
}

TEST(PythonNode, AnInvalidInputIsNone) {
  const PythonFile file(
      class_with("    def step(self, step):\n"
                 "        if step.inputs['in'] is None:\n"
                 "            assert step.revision('in') == 0\n"
                 "            assert not step.changed('in')\n"
                 "            step.invalidate('out')\n"
                 "        else:\n"
                 "            step.output('out')[:] = step.inputs['in'][::-1]\n"));
  NodeHarness node(file.node_class(), kTwo);
  node.step(kMs);
  EXPECT_EQ(node.revision(), 0U);
  node.set_input({1, 2});
  node.step(kMs);
  EXPECT_THAT(node.output(), ElementsAre(2, 1));
  EXPECT_EQ(node.revision(), 1U);
  node.invalidate_input();
  node.step(kMs);
  EXPECT_EQ(node.revision(), 0U);
  node.set_input({1, 2});
  node.step(kMs);
  EXPECT_EQ(node.revision(), 2U) << "a revision is never used twice";
}

TEST(PythonNode, SpikesComeSortedAndGo) {
  const PythonFile file(
      class_with("    def step(self, step):\n"
                 "        times, channels = step.spikes('cells')\n"
                 "        assert times.dtype == np.int64, times.dtype\n"
                 "        assert channels.dtype == np.int32\n"
                 "        assert step.spikes('cells').times_ns is times\n"
                 "        late = times <= step.begin\n"
                 "        step.emit('spikes', times[~late] + 5, 1 - channels[~late])\n"
                 "        step.emit('spikes', step.end, channels[late])\n"
                 "        step.emit('spikes', [], [])\n"));
  NodeHarness node(file.node_class(), kTwo);
  node.step(kMs);
  EXPECT_EQ(node.spike_count(), 0U);
  node.add_spike(kMs + 200, 0);
  node.add_spike(kMs + 100, 1);
  node.add_spike(kMs - 300, 1);
  node.step(kMs);
  const auto spikes = node.spikes();
  ASSERT_EQ(spikes.size(), 3U);
  EXPECT_EQ(spikes[0].time_ns, kMs + 105);
  EXPECT_EQ(spikes[0].channel, 0);
  EXPECT_EQ(spikes[1].time_ns, kMs + 205);
  EXPECT_EQ(spikes[1].channel, 1);
  EXPECT_EQ(spikes[2].time_ns, 2 * kMs);
  EXPECT_EQ(spikes[2].channel, 1);
}

TEST(PythonNode, ItsSetupSaysWhatItIs) {
  const PythonFile file(
      class_with("    tau = spikeloop.Parameter(unit='s')\n"
                 "    count = spikeloop.Parameter(7, type=int)\n"
                 "    mode = spikeloop.Parameter('a', choices=['a', 'b'])\n"
                 "    loud = spikeloop.Parameter(False)\n"
                 "    weights = spikeloop.Weights('uniform')\n"
                 "    def __init__(self, setup):\n"
                 "        assert (setup.name, setup.seed) == ('left', 2**64 - 1)\n"
                 "        assert setup.widths == {'in': 2, 'cells': 2, 'out': 2, 'spikes': 2}\n"
                 "        assert setup.parameters['tau'] == self.tau == 0.03\n"
                 "        assert (type(self.count), self.count) == (int, 7)\n"
                 "        assert (self.mode, self.loud) == ('b', True)\n"
                 "        assert self.weights.tolist() == [[0.5, 0.5], [0.5, 0.5]]\n"
                 "    def step(self, step):\n"
                 "        assert step.duration == step.end - step.begin == 1_000_000\n"
                 "        assert step.width('out') == 2\n"
                 "    def counters(self):\n"
                 "        return {'first': 3, 'second': np.int64(4)}\n"));
  NodeHarness node(file.node_class(), kTwo,
                   {.keys = {{"tau", "30 ms"}, {"mode", "b"}, {"loud", "true"}},
                    .name = "left",
                    .seed = ~std::uint64_t{0}});
  node.step(kMs);
  EXPECT_EQ(node.counter("first"), 3U);
  EXPECT_EQ(node.counter("second"), 4U);
}

TEST(PythonNode, RandomNumbersAreKeyedBySeedNameAndPurpose) {
  const PythonFile file(
      class_with("    purpose = spikeloop.Parameter(0, type=int)\n"
                 "    def __init__(self, setup):\n"
                 "        self.random = setup.random(self.purpose)\n"
                 "    def step(self, step):\n"
                 "        step.write('out', self.random.random(2))\n"));
  const auto draw = [&](const std::string& name, std::uint64_t seed, const std::string& purpose) {
    NodeHarness node(file.node_class(), kTwo,
                     {.keys = {{"purpose", purpose}}, .name = name, .seed = seed});
    node.step(kMs);
    return node.output();
  };
  EXPECT_EQ(draw("a", 1, "0"), draw("a", 1, "0"));
  EXPECT_NE(draw("a", 1, "0"), draw("b", 1, "0"));
  EXPECT_NE(draw("a", 1, "0"), draw("a", 2, "0"));
  EXPECT_NE(draw("a", 1, "0"), draw("a", 1, "1"));
}

TEST(PythonNode, ArraysAreTheGraphsOwnMemory) {
  const PythonFile file(
      class_with("    address = 0\n"
                 "    def step(self, step):\n"
                 "        self.address = step.inputs['in'].__array_interface__['data'][0]\n"
                 "    def counters(self): return {'address': self.address}\n"));
  const auto node = file.node_class().create({"n", 1, {}, kTwo});
  const std::vector<double> values = {1, 2};
  std::vector<double> out = {0, 0};
  const spikeloop_signal_input in{values.data(), 1, 2, 0};
  const spikeloop_spike_input cells{nullptr, 0, 2, 0};
  spikeloop_signal_output signal_out{out.data(), 0, 2, 0};
  spikeloop_spike_output spike_out{nullptr, nullptr, 2, 0};
  const spikeloop_step data{0, kMs, &in, &cells, &signal_out, &spike_out, 1, 1, 1, 1};
  node->step(Step(data));
  EXPECT_EQ(node->counters()[0].value, reinterpret_cast<std::uintptr_t>(values.data()));
}

TEST(PythonNode, NotANumberPasses) {
  const PythonFile file(
      class_with("    def step(self, step):\n"
                 "        step.write('out', [np.nan, np.inf])\n"));
  NodeHarness node(file.node_class(), kTwo);
  node.step(kMs);
  EXPECT_TRUE(std::isnan(node.output()[0]));
  EXPECT_TRUE(std::isinf(node.output()[1]));
}

TEST(PythonNode, OneNumberIsForAllChannels) {
  const PythonFile file(
      class_with("    def step(self, step):\n"
                 "        step.write('out', True)\n"
                 "        step.emit('spikes', step.begin + 1, [0, 1])\n"));
  NodeHarness node(file.node_class(), kTwo);
  node.step(kMs);
  EXPECT_THAT(node.output(), ElementsAre(1, 1));
  EXPECT_EQ(node.spike_count(), 2U);
}

TEST(PythonNode, TheLockIsFreeBetweenSteps) {
  const PythonFile file(
      class_with("    turns = 0\n"
                 "    def __init__(self):\n"
                 "        import threading\n"
                 "        threading.Thread(target=self.turn, daemon=True).start()\n"
                 "    def turn(self):\n"
                 "        import time\n"
                 "        while True:\n"
                 "            time.sleep(0.001)\n"
                 "            self.turns += 1\n"
                 "    def step(self, step): ...\n"
                 "    def counters(self): return {'turns': self.turns}\n"));
  NodeHarness node(file.node_class(), kTwo);
  node.step(kMs);
  const std::uint64_t before = node.counter("turns");
  // Each look gives the thread a turn itself, so there are few looks, and longer pauses on a busy
  // machine.
  std::uint64_t turns = 0;
  for (const int pause_ms : {200, 1000, 10'000}) {
    std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
    turns = node.counter("turns") - before;
    if (turns > 5) {
      break;
    }
  }
  EXPECT_GT(turns, 5U);
}

TEST(PythonNode, GarbageInACycleIsNotKept) {
  const PythonFile file(
      class_with("    def step(self, step):\n"
                 "        cycle = [step.inputs['in']]\n"
                 "        cycle.append(cycle)\n"));
  NodeHarness node(file.node_class(), kTwo);
  node.set_input({1, 2});
  node.step(kMs);
}

}  // namespace
}  // namespace spikeloop::testing
