#!/usr/bin/python3
"""A network in NEST under MUSIC does what it does in NEST alone, and in our own network, spike for
spike."""

import os
import shutil
import subprocess
import unittest

import numpy as np

import hundred_neurons
import jobs
import nest_jobs

DURATION_S = 2
SPIKES = hundred_neurons.driving_spikes(DURATION_S)


class HundredNeurons(unittest.TestCase):
    def fired(self, model, tick_s, **job):
        """(times in ns, neurons) of the network in a job."""
        with nest_jobs.NestJob("hundred_nest.py", hundred_neurons.CHANNELS, SPIKES,
                               width_out=hundred_neurons.NEURONS, tick_s=tick_s,
                               duration_s=DURATION_S, **job) as job:
            shutil.copy(jobs.HERE / "hundred_neurons.py", job.folder)
            hundred_neurons.write_files(job.folder, model)
            job.run("--quiet")
            return job.received()[:2]

    def alone(self, model):
        """The same of NEST without MUSIC, that knows all spikes before the run."""
        with nest_jobs.NestJob("hundred_nest.py", hundred_neurons.CHANNELS, SPIKES) as job:
            hundred_neurons.write_files(job.folder, model)
            path = f"{jobs.HERE}:{os.environ.get('PYTHONPATH', '')}"
            subprocess.run([nest_jobs.PYTHON, str(jobs.HERE / "hundred_nest_alone.py"), model,
                            "spikes.npy", str(DURATION_S * 1000), "fired.npy"], cwd=job.folder,
                           env={**os.environ, "PYTHONPATH": path}, check=True, timeout=120,
                           capture_output=True)
            return np.load(job.folder / "fired.npy")

    def check(self, model, least):
        alone = self.alone(model)
        self.assertGreater(alone.shape[1], least)
        self.assertGreater(len(np.unique(alone[1])), 0.9 * hundred_neurons.NEURONS)
        # Delays of NEST's own MUSIC are at least a tick, those of the network 1 ms.
        for tick_s in (0.001,) if nest_jobs.WITH_MUSIC else (0.001, 0.01):
            with self.subTest(tick_s=tick_s):
                fired = self.fired(model, tick_s, keys=f"model={model}")
                jobs.assert_same(alone, fired, f"NEST, {model}")
        own = self.fired(model, 0.001, binary="spikeloop-network", keys="network=brain.yaml")
        jobs.assert_same(alone, own, f"spikeloop-network, {model}")

    def test_exponential_currents(self):
        self.check("iaf_psc_exp", 5000)

    def test_jumps_of_the_potential(self):
        self.check("iaf_psc_delta", 10000)


if __name__ == "__main__":
    nest_jobs.main()
