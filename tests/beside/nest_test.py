#!/usr/bin/python3
"""NEST as a node of an experiment: parrot neurons answer every spike on NEST's grid, in lockstep, the
same to the bit each time. Without such a NEST it says so, and is skipped (tests/simulators/nest_jobs.py)."""

import pathlib
import sys
import tempfile
import unittest

import numpy as np

import experiments
from experiments import runs
from simulators_test import DURATION, SIMULATORS, repeat

sys.path.insert(0, str(SIMULATORS.parent))
import nest_jobs  # noqa: E402

TICK = 10**6


def expected(sent):
    """What the rules of docs/simulators.md make of these spikes."""
    times = sent[0]
    if nest_jobs.WITH_MUSIC:  # half a microsecond is a little less in NEST's milliseconds
        times = times - ((times % 1000 == 500) & (times / 1e9 * 1e3 * 1e3 < times / 1e3))
    times, in_time = nest_jobs.expected(times, -(-sent[0] // TICK) * TICK - TICK, step_ns=100_000,
                                        delay_ns=TICK, guarded=True, end_ns=DURATION)
    answers = np.stack([times, sent[1]])[:, in_time]
    return answers[:, np.lexsort((answers[1], answers[0]))]


class Nest(unittest.TestCase):
    def test_parrots_answer_the_robot(self):
        with tempfile.TemporaryDirectory() as scratch:
            scratch = pathlib.Path(scratch)
            prints = []
            for _ in range(2):
                repeat(scratch, "nest", "repeat_nest.py", expected)
                prints.append(runs.fingerprint(scratch / "nest"))
            self.assertEqual(*prints)
            experiments.run(scratch / "explorer.yaml", scratch / "other", "--seed", "2")
            self.assertNotEqual(runs.fingerprint(scratch / "other"), prints[0])


if __name__ == "__main__":
    nest_jobs.main()
