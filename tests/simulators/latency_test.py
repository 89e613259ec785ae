#!/usr/bin/python3
"""When a script sees what, and when its answer arrives: docs/simulators.md, "Time"."""

import shutil
import sys
import unittest

import numpy as np

import jobs

TICK = 1_000_000
MORE = """
[reader]
  np=1
  binary=./read_half.py
  record=false
sine.out -> brain.level [3]
sine.out -> reader.level [3]
brain.half -> reader.half [3]
"""


class Latency(unittest.TestCase):
    def run_job(self, keys):
        """(times, channels, begins of the ticks) that the script saw; the job is left in self.job."""
        self.job = jobs.Job("levels.py", 3, encoder="rate_encoder", rate_max=500, duration_s=0.5,
                            keys=keys)
        self.addCleanup(self.job.__exit__)
        shutil.copy(jobs.HERE / "scripts/read_half.py", self.job.folder)
        self.job.file.write_text(self.job.file.read_text() + MORE)
        self.job.run("--quiet")
        times, channels, begins = np.load(self.job.folder / "seen.npy")
        return (np.rint(times * 1e9).astype(np.int64), channels.astype(int),
                np.rint(begins * 1e9).astype(np.int64))

    def test_a_spike_is_seen_in_the_tick_of_its_time(self):
        times, channels, begins = self.run_job("")
        jobs.assert_same(self.job.sent(), (times, channels), "seen")
        np.testing.assert_array_equal(begins, -(-times // TICK) * TICK - TICK)
        # And the answer, sent in the same tick, is received in the same tick.
        jobs.assert_same((begins + TICK, channels), self.job.received()[:2], "received")
        np.testing.assert_array_equal(np.sort(self.job.received()[2]), np.sort(begins))

    def test_a_tick_of_latency_brings_it_a_tick_later_with_its_own_time(self):
        times, channels, begins = self.run_job("accept_latency=0.001")
        np.testing.assert_array_equal(begins, -(-times // TICK) * TICK)
        sent = self.job.sent()
        early = sent[0] <= 499 * TICK
        jobs.assert_same((sent[0][early], sent[1][early]), (times, channels), "seen")

    def test_a_tick_of_latency_and_of_delay_is_nobody_s_lateness(self):
        times, channels, begins = self.run_job("accept_latency=0.001\n  spike_delay=1")
        np.testing.assert_array_equal(begins, -(-times // TICK) * TICK - TICK)
        sent = self.job.sent()
        early = sent[0] <= 499 * TICK
        jobs.assert_same((sent[0][early] + TICK, sent[1][early]), (times, channels), "seen")

    def test_a_signal_takes_a_tick_to_the_script_and_one_from_it(self):
        self.run_job("")
        rows = np.load(self.job.folder / "rows.npy")
        self.assertTrue(np.all(np.isnan(rows[0])))
        # One hop against two: the half of a level arrives a tick after the level.
        np.testing.assert_array_equal(rows[2:, 3:], rows[1:-1, :3] / 2)
        self.assertGreater(len(np.unique(rows[1:, 0])), 400)


if __name__ == "__main__":
    sys.exit(unittest.main())
