#!/usr/bin/python3
"""NEST's part of the bench, where there is a NEST: parrots in a job, and alone."""

import os
import pathlib
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/simulators"), str(ROOT / "python")]
import nest_found  # noqa: E402: of this tree
from spikeloop.bench import chain, trial  # noqa: E402

PROGRAMS = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])


class Parrots(unittest.TestCase):
    def measured(self, layout, tick_ms):
        return trial.run(PROGRAMS, chain.Setting(layout, "rate", "nest", tick_ms, 50, 50.0, 50.0, 1.0),
                         60)

    def test_in_a_job_they_give_back_every_spike_but_the_last(self):
        for tick_ms in (50.0, 10.0):
            with self.subTest(tick_ms=tick_ms):
                # 50 Hz from the third tick on, a spike every 20 ms; those of the last ticks are held.
                spikes = self.measured("separate", tick_ms)["spikes"]
                encoded = 50 * (1000 - 2 * tick_ms) // 20
                self.assertLessEqual(spikes, encoded)
                self.assertGreaterEqual(spikes, encoded - 50 * (2 * tick_ms + 20) // 20)

    def test_alone(self):
        result = self.measured("alone", 50.0)
        self.assertEqual(result["spikes"], 50 * 50)
        self.assertAlmostEqual(result["real_time_factor"] * result["run_s"], 1.0, 3)


if __name__ == "__main__":
    directory = nest_found.directory_or_skip(sys.argv.pop(1))
    if directory:
        os.environ["PYTHONPATH"] = directory
    sys.exit(unittest.main())
