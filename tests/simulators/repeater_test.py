#!/usr/bin/python3
"""1000 neurons at 20 Hz that repeat every spike: each comes back once, when the rules say so."""

import sys
import unittest

import numpy as np

import jobs

WIDTH = 1000
DURATION_S = 0.3
END = round(DURATION_S * 1e9)


NETWORK = f"""resolution: 0.1 ms
populations:
  input: {{model: input, size: {WIDTH}}}
  relay: {{model: repeater, size: {WIDTH}}}
connections:
  - {{from: input, to: relay, rule: one_to_one, delay: 1 ms}}
output: [relay]
"""


def on_the_grid(times, channels, grid=100_000, delay=1_000_000):
    return before_the_end(-(-times // grid) * grid + delay, channels)


def before_the_end(times, channels):
    return times[times <= END], channels[times <= END]


def brian_spikes(times, channels, step=500_000):
    """A spike takes effect in the step of its time; the neuron fires in the next one; of several at
    once, one a step."""
    ends = -(-times // step) * step + step
    order = np.lexsort((ends, channels))
    last = {}
    for i in order:
        last[channels[i]] = ends[i] = max(ends[i], last.get(channels[i], -step) + step)
    return before_the_end(ends, channels)


class Repeaters(unittest.TestCase):
    def check(self, script, tick_s, expected, keys="", text=None):
        with jobs.Job(script, WIDTH, tick_s=tick_s, duration_s=DURATION_S, keys=keys, text=text) as job:
            job.run("--quiet")
            times, channels, begins = job.received()
            sent = job.sent()
            self.assertGreater(len(sent[0]), 0.9 * WIDTH * 20 * DURATION_S)
            jobs.assert_same(expected(*sent), (times, channels), script)
            jobs.assert_same((times, channels), job.recorded(), f"{script}, recorded")
            # Nothing comes late: it is received in the tick that its time belongs to.
            self.assertTrue(np.all(times > begins))
            self.assertTrue(np.all(times <= begins + round(tick_s * 1e9)))

    def test_python_repeats_at_once(self):
        for tick_s in (0.001, 0.01):
            with self.subTest(tick_s=tick_s):
                self.check("repeat_python.py", tick_s, lambda times, channels: (times, channels))

    def test_the_built_in_network_repeats_on_its_grid(self):
        for tick_s in (0.001, 0.01):
            with self.subTest(tick_s=tick_s):
                self.check("brain.yaml", tick_s, on_the_grid, text=NETWORK,
                           keys="binary=spikeloop-network\n  network=brain.yaml")

    def test_neuron_repeats_after_the_delay(self):
        for tick_s in (0.001, 0.01):
            with self.subTest(tick_s=tick_s):
                self.check("repeat_neuron.py", tick_s,
                           lambda times, channels: before_the_end(times + 1_500_000, channels))

    def test_neuron_repeats_with_variable_steps_and_no_delay(self):
        self.check("repeat_neuron.py", 0.001, lambda times, channels: (times, channels),
                   keys="cvode=true\n  delay=0")

    def test_neuron_repeats_over_two_processes(self):
        for tick_s in (0.001, 0.01):
            with self.subTest(tick_s=tick_s):
                self.check("repeat_neuron_parallel.py", tick_s,
                           lambda times, channels: before_the_end(times + 3_500_000, channels),
                           keys="np=2")

    def test_brian_repeats_a_step_later(self):
        for tick_s in (0.001, 0.01):
            with self.subTest(tick_s=tick_s):
                self.check("repeat_brian.py", tick_s, brian_spikes)


if __name__ == "__main__":
    sys.exit(unittest.main())
