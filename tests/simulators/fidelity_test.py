#!/usr/bin/python3
"""A model in a MUSIC job does what the simulator alone does with the same spikes."""

import contextlib
import shutil
import subprocess
import sys
import unittest

import h5py
import numpy as np

import jobs

PYTHON = "/usr/bin/python3"
WIDTH = 30
STEP_NS = 100_000  # Brian2's


def alone(script, *arguments):
    """What the script prints."""
    return subprocess.run([PYTHON, str(jobs.HERE / script), *map(str, arguments)], check=True,
                          cwd=jobs.HERE, capture_output=True, text=True, timeout=240).stdout


class Fidelity(unittest.TestCase):
    def neuron(self, tick_s, cvode):
        """(fired in the job, fired alone), ns."""
        with jobs.Job("hodgkin_huxley.py", WIDTH, width_out=1, tick_s=tick_s, duration_s=0.5,
                      keys=f"cvode={str(cvode).lower()}") as job:
            shutil.copy(jobs.HERE / "scripts/ball_and_stick.py", job.folder)
            job.run("--quiet")
            np.save(job.folder / "sent.npy", job.sent()[0])
            printed = alone("neuron_alone.py", job.folder / "sent.npy", 500, cvode)
            fired = np.array([float(word) for word in printed.split()]) * 1e6
            times, channels, _ = job.received()
            self.assertEqual(set(channels), {0})
            self.assertGreater(len(times), 12)
            self.assertEqual(len(times), len(fired))
            return times, fired

    def test_a_cell_of_neuron_with_fixed_steps_fires_in_the_same_steps(self):
        for tick_s in (0.001, 0.01):
            with self.subTest(tick_s=tick_s):
                times, fired = self.neuron(tick_s, cvode=False)
                # Alone, NEURON's time drifts by less than a nanosecond; on a tick's border the host
                # adds one.
                self.assertLessEqual(np.max(np.abs(times - fired)), 2)

    def test_a_cell_of_neuron_with_variable_steps_fires_at_the_same_times(self):
        times, fired = self.neuron(0.001, cvode=True)
        self.assertLess(np.max(np.abs(times - fired)), 200)  # the integrator's own tolerance

    def test_every_process_of_neuron_sends_its_share_of_a_signal(self):
        with jobs.Job("levels_parallel.py", 4, duration_s=0.1, keys="np=3") as job:
            shutil.copy(jobs.HERE / "scripts/keep_levels.py", job.folder)
            with job.file.open("a") as file:
                file.write("[levels]\n  np=1\n  binary=./keep_levels.py\n"
                           "brain.level -> levels.in [5]\n")
            job.run("--quiet")
            kept = np.load(job.folder / "levels.npy")
            self.assertGreater(len(kept), 95)
            expected = 1 + kept[:, :1] + np.arange(5) / 10  # as of the end of the tick before
            np.testing.assert_allclose(kept[:, 1:], expected, atol=1e-9)
            with h5py.File(job.out / "brain.h5") as recording:
                self.assertEqual(recording["signals/level/values"].shape, (100, 5))

    def test_a_network_of_brian2_fires_in_the_same_steps(self):
        with contextlib.ExitStack() as stack:
            done = {}
            for tick_s in (0.001, 0.01):
                job = done[tick_s] = stack.enter_context(jobs.Job(
                    "integrate_brian.py", WIDTH, encoder="rate_encoder", width_out=20, tick_s=tick_s,
                    duration_s=0.3))
                shutil.copy(jobs.HERE / "scripts/brian_network.py", job.folder)
                job.run("--quiet")
                np.save(job.folder / "sent.npy", np.stack(job.sent()))
            # Once for both: it takes seconds to import Brian2.
            alone("brian_alone.py", 300, STEP_NS, *(job.folder for job in done.values()))
            for tick_s, job in done.items():
                with self.subTest(tick_s=tick_s):
                    steps, neurons = np.load(job.folder / "fired.npy").astype(np.int64)
                    times, channels, _ = job.received()
                    self.assertGreater(len(times), 30)
                    jobs.assert_same(((steps + 1) * STEP_NS, neurons), (times, channels), "Brian2")


if __name__ == "__main__":
    sys.exit(unittest.main())
