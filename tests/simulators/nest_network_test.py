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
import nest_found
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
            subprocess.run([nest_found.PYTHON, str(jobs.HERE / "hundred_nest_alone.py"), model,
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

def precise_solution(arrivals_ms, end_ms, jump_mV=3.0, current_pA=400.0, tau_ms=10.0, t_ref_ms=2.0):
    """Times in ms at which a leaky neuron of 250 pF fires, 15 mV above rest, driven by a current and
    by jumps that are lost while it is refractory: from event to event, exactly."""
    goal, threshold, fired = current_pA / 25.0, 15.0, []
    now, potential = 0.0, 0.0
    events = [*arrivals_ms, end_ms]
    while events:
        crossing = now + tau_ms * np.log((goal - potential) / (goal - threshold))
        if crossing < events[0]:
            now = crossing
        else:
            arrival = events.pop(0)
            potential = goal + (potential - goal) * np.exp(-(arrival - now) / tau_ms)
            now, potential = arrival, potential + jump_mV
            if potential < threshold or not events:
                continue
        fired.append(now)
        now, potential = now + t_ref_ms, 0.0
        events = [event for event in events if event >= now]
    return np.array(fired)


class PreciseTimes(unittest.TestCase):
    def test_a_neuron_off_the_grid_fires_when_the_solved_equation_does(self):
        times = SPIKES[0][SPIKES[1] < 5]
        with nest_jobs.NestJob("precise_nest.py", 1, (times, np.zeros_like(times)), keys="I_e=400",
                               duration_s=DURATION_S) as job:
            job.run("--quiet")
            fired = job.received()[0] / 1e6
        solved = precise_solution(np.sort(times) / 1e6 + 1, DURATION_S * 1e3)
        self.assertGreater(len(solved), 100)
        self.assertEqual(len(fired), len(solved))
        # NEST's own MUSIC sends them rounded up to the grid.
        later = fired - solved
        self.assertLess(np.max(np.abs(later - 0.05)), 0.05001 if nest_jobs.WITH_MUSIC else 1)
        if not nest_jobs.WITH_MUSIC:
            self.assertLess(np.max(np.abs(later)), 2e-6)


class PaperExample(unittest.TestCase):
    def test_brain_py_is_brain_yaml(self):
        """Of examples/07_paper_music_file."""
        example = jobs.HERE.parents[1] / "examples/07_paper_music_file"
        times, channels = SPIKES
        own_half = channels < 20
        trains = []
        for keys in ({}, {"binary": "spikeloop-network", "keys": "network=brain.yaml"}):
            with nest_jobs.NestJob("play.py", 20, (times[own_half], channels[own_half]), width_out=21,
                                   duration_s=DURATION_S, **{"binary": "./brain.py", **keys}) as job:
                for name in ("brain.py", "brain.yaml"):
                    shutil.copy(example / name, job.folder)
                job.run("--quiet")
                trains.append(job.received()[:2])
        self.assertGreater(np.count_nonzero(trains[0][1] == 20), 100)
        jobs.assert_same(*trains, "NEST and spikeloop-network")


if __name__ == "__main__":
    nest_jobs.main()
