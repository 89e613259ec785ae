#!/usr/bin/python3
"""Continuous ports of NEST: what arrives when; potentials and rates against the solved equation."""

import shutil
import subprocess
import tempfile
import pathlib
import unittest

import numpy as np

import jobs
import nest_jobs

JOB = """\
stoptime=0.05
music_timestep=0.001
[watch]
  np=1
  binary=./watch.py
[brain]
  np=1
  binary=./{script}
[steps]
  np=1
  binary=./steps.py
  sync=unpaced
steps.level -> brain.level [2]
brain.voltage -> watch.voltage [2]
"""
TICKS = 50
SENT = np.outer(np.arange(1, TICKS + 1), [1.0, -2.0])


def relaxed(goals, tick_ms=1.0, tau_ms=10.0):
    """x at the end of every tick, from 0, of tau dx/dt = goal - x: the exact solution for goals that
    are constant in a tick."""
    decay = np.exp(-tick_ms / tau_ms)
    x, rows = np.zeros(goals.shape[1]), []
    for goal in goals:
        x = goal + (x - goal) * decay
        rows.append(x)
    return np.array(rows)


class ContinuousPorts(unittest.TestCase):
    def run_job(self, script):
        """Rows by the names of the files that the scripts have written."""
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for each in (script, "steps.py", "watch.py"):
                shutil.copy(jobs.HERE / "scripts" / each, folder)
            (folder / "job.music").write_text(JOB.format(script=script))
            done = subprocess.run([str(jobs.SPIKELOOP), "run", "job.music", "--quiet"], cwd=folder,
                                  capture_output=True, text=True, timeout=120, check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            return {path.stem: np.load(path) for path in folder.glob("*.npy")}

    def test_a_signal_drives_neurons_whose_potentials_are_another(self):
        rows = self.run_job("ports_nest.py")
        seen, got = rows["seen"], rows["rows"]
        self.assertEqual(seen.shape, (TICKS, 2))
        # A tick a hop; NEST's own MUSIC takes one more each.
        late = 2 if nest_jobs.WITH_MUSIC else 1
        self.assertTrue(np.all(np.isnan(seen[:late])))
        np.testing.assert_array_equal(seen[late:], SENT[:-late])
        # 10 ms and 250 pF are 40 MOhm. A current that is set acts in the tick that begins.
        expected = relaxed(np.nan_to_num(seen) * 0.04) - 70
        np.testing.assert_allclose(got[late:], expected[:-late], atol=1e-9, rtol=0)
        self.check_before_the_first(got[:late])

    def test_a_signal_is_the_input_of_rate_neurons_whose_rates_are_another(self):
        got = self.run_job("rates_nest.py")["rows"]
        expected = relaxed(np.concatenate([np.zeros((1, 2)), SENT]))
        np.testing.assert_allclose(got[1:], expected[:TICKS - 1], atol=1e-9, rtol=0)
        self.check_before_the_first(got[:1])

    def check_before_the_first(self, rows):
        self.assertTrue(np.all(rows == 0 if nest_jobs.WITH_MUSIC else np.isnan(rows)))


if __name__ == "__main__":
    nest_jobs.main()
