#!/usr/bin/python3
"""The scripts of docs/simulators.md run as they stand there."""

import re
import sys
import unittest

import numpy as np

import jobs

PAGE = jobs.HERE.parents[1] / "docs/simulators.md"
LOST = """#!/usr/bin/python3
import spikeloop.neuron
from neuron import h

class Cell:
    def __init__(self):
        self.soma, self.dendrite = h.Section(name="soma"), h.Section(name="dendrite")
        self.dendrite.connect(self.soma)
        self.soma.insert("hh")
        self.synapse = h.ExpSyn(self.dendrite(0.5))
        self.synapse.tau = 2

with spikeloop.neuron.music(spikes_in={"in": None}, spikes_out={"out": None}) as host:
    for channel in range(host.widths["in"]):
        cell = Cell()  # nobody keeps it
        host.connect_input("in", channel, cell.synapse, weight=2, delay_ms=1)
        host.connect_output("out", channel, cell.soma(0.5)._ref_v, sec=cell.soma, threshold_mV=0)
    del cell
    assert sum(1 for _ in h.allsec()) == 2 * host.widths["in"]
    host.run()
"""


def snippet(title, number=0):
    """A block of Python of the page's section, with the first line and the imports that it needs."""
    section = PAGE.read_text().split(f"\n## {title}\n")[1].split("\n## ")[0]
    text = re.findall(r"```python\n(.*?)```", section, re.DOTALL)[number]
    if not text.startswith("#!"):
        text = "#!/usr/bin/python3\nimport spikeloop.neuron\nfrom neuron import h\n" + text
    return text


class Snippets(unittest.TestCase):
    def fired(self, text, width, keys="", duration_s=0.3):
        """(spikes that were sent, (times, channels) that came back)"""
        with jobs.Job("brain.py", width, text=text, encoder="rate_encoder", rate_max=40,
                      duration_s=duration_s, keys=keys) as job:
            # Brian2 reads it; compilation would take most of the test's time.
            (job.folder / "brian_preferences").write_text("[codegen]\ntarget = 'numpy'\n")
            job.run("--quiet")
            times, channels, _ = job.received()
            return len(job.sent()[0]), (times, channels)

    def test_a_script(self):
        sent, (times, _) = self.fired(snippet("A script"), 100)
        self.assertEqual(len(times), sent)

    def test_neuron(self):
        sent, (times, _) = self.fired(snippet("NEURON"), 1)
        self.assertEqual(len(times), sent)  # a strong synapse at a low rate

    def test_neuron_in_several_processes(self):
        text = snippet("NEURON", 2)
        sent, one = self.fired(text, 100, keys="np=1", duration_s=0.6)
        jobs.assert_same(one, self.fired(text, 100, keys="np=2", duration_s=0.6)[1], "two processes")
        self.assertEqual(len(one[0]), sent)
        self.assertEqual(set(one[1]), set(range(100)))

    def test_cells_of_neuron_that_no_variable_holds(self):
        sent, (times, channels) = self.fired(LOST, 5, duration_s=0.6)
        self.assertEqual(len(times), sent)
        self.assertEqual(set(channels), set(range(5)))

    def test_brian2(self):
        sent, (times, channels) = self.fired(snippet("Brian2"), 100)
        self.assertTrue(0.95 * sent < len(times) <= sent)  # the last ones after the end
        self.assertTrue(np.all(channels < 100))


if __name__ == "__main__":
    sys.exit(unittest.main())
