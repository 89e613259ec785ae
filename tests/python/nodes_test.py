"""Nodes without the C++ programs: declarations, spikeloop.testing, and what their errors say."""

import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import spikeloop
from spikeloop import NodeError, Parameter, Signal, Spikes, Weights, node
from spikeloop.declare import definition_of
from spikeloop.steps import name_hash
from spikeloop.testing import NodeRunner, run_node

MS = 1_000_000
EXAMPLE = pathlib.Path(__file__).parents[2] / "examples/05_encoder_python/encoder.py"


def load_example():
    spec = importlib.util.spec_from_file_location("example_encoder", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.MyRateEncoder


@node(inputs={"in": "signal"}, outputs={"out": Signal(same_as="in")}, gain=2.0)
def amplify(step, gain):
    """Multiplies its input."""
    if step.changed("in"):
        step.write("out", gain * step.inputs["in"])


@node
class Counting:
    inputs = {"cells": Spikes(), "pair": Signal(width=2)}
    outputs = {"total": Signal(width=1), "echo": Spikes(same_as="cells")}
    total = 0
    weights = Weights("uniform")

    def step(self, step):
        times, channels = step.spikes("cells")
        self.total += len(times)
        step.write("total", self.total)
        step.emit("echo", np.maximum(times, step.begin + 1), channels)

    def counters(self):
        return {"spikes": self.total}


class Says(unittest.TestCase):
    def says(self, text, action, /, *arguments, **named):
        with self.assertRaises(NodeError) as caught:
            action(*arguments, **named)
        self.assertEqual(str(caught.exception), text)


class RunnerTest(Says):
    def test_the_example_spikes_at_the_rate(self):
        run = run_node(load_example(), {"in": [[1.0, 0.0, -1.0]]}, period=100 * MS, tick=MS)
        times, channels = run.spikes("out")
        np.testing.assert_array_equal(times[channels == 0], np.arange(1, 11) * 10 * MS)
        np.testing.assert_array_equal(times[channels == 1], np.arange(1, 6) * 20 * MS)
        self.assertEqual(run.counters(), {"spikes": 15})

    def test_a_function_is_a_node(self):
        runner = NodeRunner(amplify, widths={"in": 2}, gain=-3)
        runner.step()
        self.assertIsNone(runner.values("out"))
        runner.set("in", [1, 2])
        runner.step()
        np.testing.assert_array_equal(runner.values("out"), [-3, -6])
        self.assertEqual(runner.time, 2 * MS)

    def test_signals_may_be_taken_back(self):
        seen = []

        @node(inputs={"in": Signal(width=1)})
        def look(step):
            seen.append((step.inputs["in"] is None, step.changed("in")))

        runner = NodeRunner(look)
        runner.set("in", 1)
        runner.run_until(2 * MS)
        runner.set("in", None)
        runner.step()
        self.assertEqual(seen, [(False, True), (False, False), (True, False)])

    def test_spikes_arrive_and_leave(self):
        runner = NodeRunner(Counting, widths={"cells": 3})
        runner.step()
        runner.send("cells", [MS + 7, MS + 2], [0, 2])
        runner.send("cells", 5, 1)
        runner.step()
        times, channels = runner.spikes("echo")
        self.assertEqual(times.tolist(), [MS + 1, MS + 2, MS + 7])
        self.assertEqual(channels.tolist(), [1, 2, 0])
        self.assertEqual(runner.values("total").tolist(), [3])
        self.assertEqual(runner.counters(), {"spikes": 3})

    def test_checks_are_those_of_a_job(self):
        @node(inputs={"in": Signal(width=2)}, outputs={"out": Signal(width=2)}, what="")
        def wrong(step, what):
            values = step.inputs["in"]
            exec(what)

        def run(what):
            return run_node(wrong, {"in": [[1, 2]]}, what=what)

        for error, text, what in ((NodeError, "'out', .* 3 values.* 2 channels", "step.write('out', [1, 2, 3])"),
                                  (ValueError, "read-only", "values[0] = 3"),
                                  (NodeError, "port 'in'", "global kept; kept = values")):
            with self.assertRaisesRegex(error, text):
                run(what)

    def test_a_step_that_is_over_answers_no_more(self):
        kept = []

        @node(inputs={"in": Signal(width=2)}, outputs={"out": Signal(width=2)})
        def keeps(step):
            kept.append(step)

        run_node(keeps, {"in": [[1, 2]]})
        for late in (lambda: kept[0].inputs["in"], lambda: kept[0].changed("in"), lambda: kept[0].write("out", 1)):
            with self.assertRaisesRegex(NodeError, r" step\(\) only"):
                late()

    def test_what_the_runner_refuses(self):
        self.says("how wide is 'in'? write widths={'in': 1}", NodeRunner, amplify)
        self.says("there is no port 'inn'; did you mean 'in'?", NodeRunner, amplify, {"inn": 1})
        self.says("port 'out' is as wide as 'in', which has 1 channels, not 2", NodeRunner, amplify,
                  {"in": 1, "out": 2})
        self.says("port 'pair' has 2 channels, not 3", NodeRunner, Counting,
                  {"cells": 1, "pair": 3})
        self.says("there is no parameter 'gian'; did you mean 'gain'?", NodeRunner, amplify,
                  {"in": 1}, gian=3)
        self.says("parameter 'gain' is 'loud'; write a finite number", NodeRunner, amplify,
                  {"in": 1}, gain="loud")
        runner = NodeRunner(amplify, {"in": 2})
        self.says("input 'in' got 3 values; write 2", runner.set, "in", [1, 2, 3])
        self.says("there is no signal 'out' among the inputs; known: in", runner.set, "out", 1)
        self.says("there is no port of spikes 'out' among the outputs", runner.spikes, "out")
        self.says("'f' is not a node; write @spikeloop.node before it", NodeRunner,
                  type("f", (), {}))
        self.says("'More' is not a node; write @spikeloop.node before it", NodeRunner,
                  type("More", (Counting,), {}))

        @node(inputs={"in": Signal(width=1)}, must=Parameter(unit="s"))
        def needs(step, must): ...

        self.says("parameter 'must' is missing; write must=...", NodeRunner, needs)

    def test_a_class_may_inherit(self):
        @node
        class More(Counting):
            extra = Parameter(3, type=int)

        definition = definition_of(More)
        self.assertEqual((definition.name, list(definition.parameters)),
                         ("more", ["weights", "extra"]))

    def test_random_numbers_are_those_of_a_name(self):
        # The known answer of FNV-1a, 64 bit, for "a".
        self.assertEqual(name_hash("a"), 0xAF63DC4C8601EC8C)


class DeclarationTest(Says):
    def declare(self, **attributes):
        return node(type("It", (), {"step": lambda self, step: None, "outputs": {"out": Signal()},
                                    **attributes}))

    def test_what_is_declared(self):
        definition = definition_of(amplify)
        self.assertEqual((definition.name, definition.text), ("amplify", "Multiplies its input"))
        self.assertEqual(definition.parameters["gain"].default_text(), "2")
        self.assertEqual(definition_of(load_example()).name, "my_rate_encoder")
        self.assertEqual(node(name="other")(type("X", (Counting,), {})).__spikeloop__.name, "other")

    def test_defaults_are_written_as_a_user_would(self):
        for default, text in ((100, "100"), (0.03, "0.03"), (1e-9, "1e-09"), (1e300, "1e+300"),
                              (True, "true"), ("word", "word"), (-2.5, "-2.5")):
            self.assertEqual(Parameter(default).default_text(), text)
        self.assertIsNone(Parameter(unit="s").default_text())
        for micro in ("us", "\N{MICRO SIGN}s", "\N{GREEK SMALL LETTER MU}s"):
            self.assertEqual(Parameter(3, unit=micro).unit, "us")

    def test_ports(self):
        self.says("a port has width=2 and same_as='in'; write one of them", Signal, 2, "in")
        self.says("a port has width=0; write a whole number from 1, or leave it out for as many "
                  "channels as the connection has", Signal, width=0)
        self.says("the text of a port is 'a\\nb'; write one line", Signal, text="a\nb")
        self.says("node 'it' has no port; write for example inputs = {\"in\": spikeloop.Signal()}",
                  self.declare, outputs={})
        self.says("node 'it': an input and an output are both named 'out'; give one another name",
                  self.declare, inputs={"out": Signal()})
        self.says("node 'it': port 'out' is as wide as 'inn', which is not a port of it; did you mean "
                  "'in'?", self.declare, inputs={"in": Signal()},
                  outputs={"out": Signal(same_as="inn")})
        self.says("node 'it': same_as leads from port 'a' back to 'a'; leave it out of one of them",
                  self.declare, outputs={"a": Signal(same_as="b"), "b": Signal(same_as="a")})
        self.says("node 'it': inputs is ['in']; write a dict such as {\"in\": spikeloop.Signal()}",
                  self.declare, inputs=["in"])
        self.says("node 'it': 'a b' is not a name for a port; write letters, digits and _, such as "
                  "'in'", self.declare, inputs={"a b": Signal()})
        self.says("node 'it': port 'in' is 3; write spikeloop.Signal() or spikeloop.Spikes()",
                  self.declare, inputs={"in": 3})

    def test_parameters(self):
        self.says("there is no unit 'mile'; write one of: "
                  + ", ".join(spikeloop.declare.UNITS[1:]), Parameter, 1, unit="mile")
        self.says("a parameter that is a text has no unit and no bounds; write its default as a "
                  "number in its unit, such as 0.03 for 30 ms", Parameter, "30 ms", unit="s")
        self.says("minimum=2 is not below maximum=1; exchange them", Parameter, 1, minimum=2,
                  maximum=1)
        self.says("the default is 5, which is out of bounds; write a number from 0 to 1", Parameter,
                  5, minimum=0, maximum=1)
        self.says("the default is nan; write a finite number", Parameter, float("nan"))
        self.says("the default is 2.5; write a whole number", Parameter, 2.5, type=int)
        self.says("the default is 'c'; write one of: a, b", Parameter, "c", choices=["a", "b"])
        self.says("a choice is 'a|b'; write texts without '|'", Parameter, "a", choices=["a|b"])
        self.says("the default is 1; write True or False", Parameter, 1, type=bool)
        self.says("the default is 3; write one line of text", Parameter, 3, type=str)
        self.says("a parameter of type list; write a number, a text, True or False, or "
                  "spikeloop.Weights for a table", Parameter, [1])
        self.says("the text of a parameter is 3; write one line", Parameter, 1, text=3)

    def test_classes_and_functions(self):
        def wrong_name(step, gian): ...

        self.says("class It: 'inputs' stands in @spikeloop.node(...); write it as an attribute of "
                  "the class", node(inputs={}), type("It", (), {}))
        self.says("class It has no step; write  def step(self, step): ...", node,
                  type("It", (), {}))
        self.says("'3d' is not a name for a node; write one such as my_encoder with "
                  "@spikeloop.node(name=...)", node(name="3d", outputs={"o": "signal"}),
                  lambda step: None)
        self.says("wrong_name() takes (step, gian), but its node has (step, gain); write  def "
                  "wrong_name(step, gain):",
                  node(outputs={"o": "signal"}, gain=1), wrong_name)
        self.says("@spikeloop.node stands before 3; write it before a class or a function",
                  node(), 3)


class PageTest(unittest.TestCase):
    """docs/python-nodes.md: what it shows prints what it says."""

    def test_the_complete_example_and_its_experiment(self):
        text = (pathlib.Path(os.environ["SPIKELOOP_DOCS"]) / "python-nodes.md").read_text(encoding="utf-8")
        blocks = re.split("```.*\n", text)[1::2]
        with tempfile.TemporaryDirectory() as folder:
            for name, block in zip(("gain.py", "louder.yaml", "ratio.py"), blocks):
                pathlib.Path(folder, name).write_text(block, encoding="utf-8")
            for name in ("gain.py", "ratio.py"):
                ended = subprocess.run([sys.executable, name], cwd=folder, capture_output=True, text=True, check=True)
                self.assertIn("    $ PYTHONPATH=PREFIX/share/spikeloop/python /usr/bin/python3 "
                              f"{name}\n    {ended.stdout}", text)


class ImportTest(unittest.TestCase):
    def test_importing_the_package_is_cheap(self):
        code = ("import sys, spikeloop; print([m for m in ('numpy', 'h5py', 'matplotlib') "
                "if m in sys.modules])")
        ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                               check=True, env=os.environ)
        self.assertEqual(ended.stdout, "[]\n")


if __name__ == "__main__":
    unittest.main()
