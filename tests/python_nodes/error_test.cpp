// What a Python node does wrong ends the run with one line that says where, and what to write.
#include "python_file.hpp"
#include "spikeloop/core/graph.hpp"

namespace spikeloop::testing {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// The message of a step whose body is this one line, at line 8 of its file.
std::string step_error(const std::string& line) {
  const PythonFile file(class_with("    def step(self, step):\n        " + line + "\n"));
  NodeHarness node(file.node_class(), kTwo);
  node.set_input({1, 2});
  node.add_spike(5, 1);
  return file.without_directory(message_of([&] { node.step(kMs); }));
}

TEST(PythonError, WrittenValues) {
  EXPECT_EQ(
      step_error("step.write('out', [1, 2, 3])"),
      "nodes.py:8: in step: step.write('out', ...) got 3 values, but the port has 2 channels; "
      "write 2 values");
  EXPECT_THAT(step_error("step.write('out', [[1, 2]])"),
              Fault("nodes.py:8: in step: step.write('out', ...) got values of the shape 1 x 2 ... "
                    "2 channels ... 2 values"));
  EXPECT_THAT(
      step_error("step.write('out', [1])"),
      Fault("nodes.py:8: in step: step.write('out', ...) got 1 value ... 2 channels ... 2 values"));
  EXPECT_EQ(step_error("step.write('out', [1j, 2])"),
            "nodes.py:8: in step: step.write('out', ...) got values of type complex128; write real "
            "numbers");
  EXPECT_EQ(
      step_error("step.write('out', 'loud')"),
      "nodes.py:8: in step: step.write('out', ...) got values of type <U4; write real numbers");
  EXPECT_EQ(step_error("step.write('out', None)"),
            "nodes.py:8: in step: step.write('out', ...) got None; write real numbers");
}

TEST(PythonError, EmittedSpikes) {
  EXPECT_EQ(step_error("step.emit('spikes', 0, 0)"),
            "nodes.py:8: in step: step.emit('spikes', ...) got a spike at 0 ns, outside of the "
            "interval (0, 1000000] ns; write times after step.begin, and up to step.end");
  EXPECT_THAT(step_error("step.emit('spikes', [7, step.end + 1], [0, 1])"),
              HasSubstr("got a spike at 1000001 ns, outside of the interval (0, 1000000] ns"));
  EXPECT_EQ(
      step_error("step.emit('spikes', 7, [0, 2])"),
      "nodes.py:8: in step: step.emit('spikes', ...) got channel 2, but the port has channels "
      "0 to 1");
  EXPECT_THAT(step_error("step.emit('spikes', 7, -1)"), HasSubstr("got channel -1, but the port"));
  EXPECT_THAT(step_error("step.emit('spikes', [7], [2**32])"),
              HasSubstr("got channel 4294967296, but the port"));
  EXPECT_EQ(step_error("step.emit('spikes', [0.5], [0])"),
            "nodes.py:8: in step: step.emit('spikes', ...) got times that are float64; write whole "
            "nanoseconds: np.rint(seconds * 1e9).astype(np.int64)");
  EXPECT_EQ(step_error("step.emit('spikes', 7, np.array([True, False]))"),
            "nodes.py:8: in step: step.emit('spikes', ...) got channels that are bool; write whole "
            "numbers from 0: channels.astype(np.int32), np.flatnonzero(mask)");
  EXPECT_EQ(
      step_error("step.emit('spikes', [7, 8], [0, 1, 1])"),
      "nodes.py:8: in step: step.emit('spikes', ...) got 2 times and 3 channels; write as many "
      "times as channels");
  EXPECT_THAT(step_error("step.emit('spikes', [7, 8], [])"),
              HasSubstr("got 2 times and 0 channels; write as many times as channels"));
}

TEST(PythonError, Ports) {
  EXPECT_EQ(step_error("step.inputs['inn']"),
            "nodes.py:8: in step: there is no signal input 'inn'; did you mean 'in'?");
  EXPECT_EQ(step_error("step.inputs['cells']"),
            "nodes.py:8: in step: 'cells' carries spikes, not a signal; use step.spikes");
  EXPECT_EQ(step_error("step.spikes('in')"),
            "nodes.py:8: in step: 'in' carries a signal, not spikes; use step.inputs");
  EXPECT_EQ(step_error("step.changed('cells')"),
            "nodes.py:8: in step: 'cells' carries spikes, not a signal; use step.spikes");
  EXPECT_EQ(step_error("step.emit('out', 7, 0)"),
            "nodes.py:8: in step: 'out' carries a signal, not spikes; use step.write");
  EXPECT_EQ(step_error("step.write('spikes', 7)"),
            "nodes.py:8: in step: 'spikes' carries spikes, not a signal; use step.emit");
  EXPECT_EQ(step_error("step.write('outt', 7)"),
            "nodes.py:8: in step: there is no signal output 'outt'; did you mean 'out'?");
  EXPECT_EQ(step_error("step.width('xyz')"),
            "nodes.py:8: in step: there is no port 'xyz'; known: in, cells, out, spikes");
}

TEST(PythonError, InputsAreReadOnly) {
  EXPECT_EQ(step_error("step.inputs['in'][0] = 3"),
            "nodes.py:8: in step: ValueError: assignment destination is read-only; inputs are "
            "read-only: work on a copy, as step.inputs['in'].copy()");
  EXPECT_THAT(step_error("step.spikes('cells').times_ns[0] = 3"),
              HasSubstr("inputs are read-only"));
  EXPECT_THAT(step_error("step.inputs['in'].flags.writeable = True"),
              EndsWith("ValueError: cannot set WRITEABLE flag to True of this array"));
}

TEST(PythonError, ArraysAreNotKept) {
  const std::string remedy =
      " beyond its step; its memory is the graph's and changes: keep a copy, .copy()";
  EXPECT_EQ(step_error("self.kept = step.inputs['in']"),
            "the node keeps the array of port 'in'" + remedy);
  EXPECT_EQ(step_error("self.kept = step.inputs['in'][1:]"),
            "the node keeps the array of port 'in'" + remedy);
  EXPECT_EQ(step_error("self.kept = step.spikes('cells').channels"),
            "the node keeps the array of port 'cells'" + remedy);
  EXPECT_EQ(step_error("self.kept = step.output('out')"),
            "the node keeps the array of port 'out'" + remedy);
}

TEST(PythonError, TheStepIsOver) {
  const PythonFile file(
      class_with("    def step(self, step):\n"
                 "        if step.begin == 0:\n"
                 "            self.old = step\n"
                 "    def counters(self):\n"
                 "        self.old.write('out', 1)\n"));
  NodeHarness node(file.node_class(), kTwo);
  node.step(kMs);
  const std::string over = "the step is over; use it inside the node's step() only";
  EXPECT_EQ(file.without_directory(message_of([&] { node.counter("x"); })),
            "nodes.py:11: in counters: " + over);
}

TEST(PythonError, Returns) {
  EXPECT_EQ(
      step_error("return step.inputs['in'] * 2"),
      "step() gave back a ndarray; write step.write(PORT, values) or step.emit(PORT, times_ns, "
      "channels), and return nothing");
}

TEST(PythonError, ExceptionsHaveTheirPlaceAndTheTracebackIsLogged) {
  const PythonFile file(
      "def half(x):\n"
      "    return x / 0\n" +
      class_with("    def step(self, step):\n        self.x = half(1)\n"));
  NodeHarness node(file.node_class(), kTwo);
  EXPECT_EQ(file.without_directory(message_of([&] { node.step(kMs); })),
            "nodes.py:4: in half: ZeroDivisionError: division by zero");
  ASSERT_EQ(file.lines.size(), 8U);
  EXPECT_EQ(file.lines[0], "Traceback (most recent call last):");
  EXPECT_EQ(file.without_directory(file.lines[1]), "  File \"nodes.py\", line 10, in step");
  EXPECT_EQ(file.lines[2], "    self.x = half(1)");
  EXPECT_EQ(file.without_directory(file.lines[4]), "  File \"nodes.py\", line 4, in half");
  EXPECT_EQ(file.lines[7], "ZeroDivisionError: division by zero");
}

TEST(PythonError, ExceptionsOfAllKinds) {
  EXPECT_EQ(step_error("raise SystemExit"),
            "nodes.py:8: in step: SystemExit: 0; a node must not end the program: raise another "
            "exception");
  EXPECT_EQ(step_error("raise KeyboardInterrupt"), "nodes.py:8: in step: KeyboardInterrupt");
  EXPECT_EQ(step_error("class E(Exception):\n            def __str__(self): return 1 / 0\n"
                       "        raise E"),
            "nodes.py:10: in step: E (its text cannot be had: str() raised ZeroDivisionError)");
  EXPECT_EQ(step_error("raise ValueError('two\\nlines')"),
            "nodes.py:8: in step: ValueError: two lines");
  EXPECT_EQ(step_error("raise ValueError('\\udc80')"), "nodes.py:8: in step: ValueError: \\udc80");
  const std::string long_one = step_error("raise ValueError(5000 * 'x' + 'the end')");
  EXPECT_LT(long_one.size(), 1300U);
  EXPECT_THAT(long_one, EndsWith("xthe end"));
  EXPECT_THAT(step_error("self.step(step)"),
              HasSubstr("RecursionError: maximum recursion depth exceeded"));
}

TEST(PythonError, EvenWhenItCannotBeDescribed) {
  EXPECT_EQ(step_error("import spikeloop.node_host as host\n"
                       "        real = host.report\n"
                       "        def once(*_):\n"
                       "            host.report = real\n"
                       "            raise MemoryError\n"
                       "        host.report = once\n"
                       "        raise ValueError"),
            "ValueError, and an error while its place was looked for");
}

TEST(PythonError, OfMakingANode) {
  const PythonFile file(
      class_with("    def __init__(self, setup):\n"
                 "        raise ValueError('no')\n"
                 "    def step(self, step): ...\n"));
  EXPECT_EQ(file.without_directory(message_of([&] { NodeHarness(file.node_class(), kTwo); })),
            "nodes.py:8: in __init__: ValueError: no [SL0402]");
}

std::string counters_error(const std::string& given) {
  const PythonFile file(
      class_with("    def step(self, step): ...\n"
                 "    def counters(self): return " +
                 given + "\n"));
  NodeHarness node(file.node_class(), kTwo);
  return file.without_directory(message_of([&] { node.counter("x"); }));
}

TEST(PythonError, OfCounters) {
  EXPECT_EQ(
      counters_error("[1]"),
      "counters() gave back a list; write a dict of at most 32 counts, such as {\"clipped\": 3}");
  EXPECT_THAT(counters_error("{f'c{i}': i for i in range(33)}"),
              StartsWith("counters() gave back 33 entries; write a dict of at most 32 counts"));
  EXPECT_EQ(counters_error("{'a b': 1}"),
            "counters() has the name 'a b'; write letters, digits and _");
  EXPECT_EQ(counters_error("{'a': -1}"), "counters(): 'a' is -1; write a whole number from 0");
  EXPECT_THAT(counters_error("{'a': 0.5}"), Fault("counters(): 'a' is 0.5 ... 0"));
  EXPECT_THAT(counters_error("{'a': 'b'}"), Fault("counters(): 'a' is 'b' ... 0"));
  EXPECT_EQ(counters_error("1 / 0"),
            "nodes.py:8: in counters: ZeroDivisionError: division by zero");
}

TEST(PythonError, AGraphAddsTheNodesName) {
  const PythonFile file(
      "@spikeloop.node\n"
      "class It:\n"
      "    outputs = {'out': spikeloop.Signal(width=1)}\n"
      "    def step(self, step):\n"
      "        if step.begin > 0: raise ValueError('no')\n"
      "    def counters(self): return {'a': 1 / 0}\n");
  const NodeClass it = file.node_class();
  GraphDescription description;
  description.tick = kMs;
  description.nodes = {{"left", &it, {}, {}}};
  Graph graph(description);
  graph.step();
  EXPECT_EQ(file.without_directory(message_of([&] { graph.counters(); })),
            "node 'left': nodes.py:8: in counters: ZeroDivisionError: division by zero [SL0704]");
  EXPECT_EQ(file.without_directory(message_of([&] { graph.step(); })),
            "node 'left': nodes.py:7: in step: ValueError: no [SL0704]");
}

}  // namespace
}  // namespace spikeloop::testing
