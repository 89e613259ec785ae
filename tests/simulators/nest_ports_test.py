#!/usr/bin/python3
"""Continuous ports of NEST: what arrives when, and potentials against the solved equation."""

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


def potentials(levels, tick_ms=1.0, tau_ms=10.0, resistance_GOhm=0.04):
    """Of a leaky membrane at the end of every tick, from -70 mV, driven by these currents in pA: the
    exact solution for a current that is constant in a tick."""
    decay = np.exp(-tick_ms / tau_ms)
    potential, rows = np.full(levels.shape[1], 0.0), []
    for level in levels:
        goal = level * resistance_GOhm
        potential = goal + (potential - goal) * decay
        rows.append(potential - 70)
    return np.array(rows)


class ContinuousPorts(unittest.TestCase):
    def test_a_signal_drives_neurons_whose_potentials_are_another(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for script in ("ports_nest.py", "steps.py", "watch.py"):
                shutil.copy(jobs.HERE / "scripts" / script, folder)
            (folder / "job.music").write_text(JOB.format(script="ports_nest.py"))
            done = subprocess.run([str(jobs.SPIKELOOP), "run", "job.music", "--quiet"], cwd=folder,
                                  capture_output=True, text=True, timeout=120, check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            seen, rows = np.load(folder / "seen.npy"), np.load(folder / "rows.npy")
        self.assertEqual(seen.shape, (TICKS, 2))
        # A tick a hop; NEST's own MUSIC takes one more each.
        late = 2 if nest_jobs.WITH_MUSIC else 1
        sent = np.outer(np.arange(1, TICKS + 1), [1.0, -2.0])
        self.assertTrue(np.all(np.isnan(seen[:late])))
        np.testing.assert_array_equal(seen[late:], sent[:-late])
        # A current that is set acts in the tick that begins.
        expected = potentials(np.nan_to_num(seen))
        np.testing.assert_allclose(rows[late:], expected[:-late], atol=1e-9, rtol=0)
        first = rows[:late]
        self.assertTrue(np.all(first == 0 if nest_jobs.WITH_MUSIC else np.isnan(first)))


if __name__ == "__main__":
    nest_jobs.main()
