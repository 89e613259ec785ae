"""The network of 100 neurons (tests/simulators/hundred_neurons.py) in the built-in simulator, Brian2 and
NEURON, driven by the same spikes; without a grid, against an event-driven solution of our own."""

import heapq
import json
import math
import os
import pathlib
import subprocess
import sys
import unittest

import numpy as np

SIMULATORS = pathlib.Path(__file__).resolve().parents[1] / "simulators"
sys.path.insert(0, str(SIMULATORS))

import built_in  # noqa: E402
import hundred_neurons  # noqa: E402
from built_in import MS  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
DURATION_S, DURATION_MS = 0.25, "250"


def in_order(times, neurons):
    order = np.lexsort((neurons, times))
    return np.asarray(times)[order], np.asarray(neurons)[order]


def solve(parameters, factor, times_ns, channels, duration_ms, delays=None):
    """iaf_psc_delta event by event, in ns, with nothing of the grid's. What reaches a neuron in one
    nanosecond acts at once; a crossing by the constant current is rounded up to the next one."""
    p = parameters
    way, low = p["V_th"] - p["E_L"], p["V_reset"] - p["E_L"]
    drive = p["I_e"] * p["tau_m"] / p["C_m"]
    dead, tau = round(p["t_ref"] * MS), p["tau_m"] * MS
    out = {"input": [[] for _ in range(hundred_neurons.CHANNELS)],
           "cells": [[] for _ in range(hundred_neurons.NEURONS)]}
    first = {"excitatory": 0, "inhibitory": 80}
    for pre, post, delay_ms in delays or hundred_neurons.PROJECTIONS:
        table = factor * hundred_neurons.weights("iaf_psc_delta", pre, post)
        for target, source in zip(*np.nonzero(table)):
            start = out["input"][source] if pre == "input" else out["cells"][first[pre] + source]
            start.append((round(delay_ms * MS), first[post] + target, table[target, source]))
    arriving = {}  # (time, neuron) -> weights
    heap = []

    def send(links, time):
        for delay, target, weight in links:
            key = (time + delay, target)
            if key not in arriving:
                arriving[key] = []
                heapq.heappush(heap, (*key, 0))
            arriving[key].append(weight)

    for time, channel in zip(times_ns, channels):
        send(out["input"][channel], int(time))
    value, since = np.zeros(100), np.zeros(100, dtype=np.int64)
    lost, version = np.full(100, -1, dtype=np.int64), np.zeros(100, dtype=np.int64)
    fired = []

    def plan(i):
        version[i] += 1
        if drive > way:
            wait = tau * math.log((drive - value[i]) / (drive - way))
            heapq.heappush(heap, (int(since[i]) + math.ceil(wait), i, int(version[i])))

    for i in range(100):
        plan(i)
    while heap:
        time, i, kind = heapq.heappop(heap)
        if time > duration_ms * MS:
            break
        if kind and kind != version[i]:
            continue
        if time <= lost[i]:
            arriving.pop((time, i), None)
            continue
        now = way if kind else drive + (value[i] - drive) * math.exp((since[i] - time) / tau)
        now += sum(arriving.pop((time, i), ()))
        value[i], since[i] = now, time
        if now >= way:
            fired.append((time, i))
            value[i], since[i], lost[i] = low, time + dead, time + dead
            send(out["cells"][i], time)
        plan(i)
    return in_order(*np.array(fired).T)


class Case(built_in.FolderCase):
    def own(self, model, drive, duration_s, changes=(), **options):
        """What the built-in network fires; `changes`: texts of brain.yaml and what replaces them."""
        hundred_neurons.write_files(self.folder, model)
        text = (self.folder / "brain.yaml").read_text()
        for before, after in changes:
            self.assertIn(before, text)
            text = text.replace(before, after)
        (self.folder / "brain.yaml").write_text(text)
        folder = self.folder / f"run-{len(list(self.folder.glob('run-*')))}"
        run = built_in.run(folder, str(self.folder / "brain.yaml"), duration_s,
                           built_in.Spikes(*drive), hundred_neurons.CHANNELS, **options)
        return in_order(*run.stream("out"))

    def elsewhere(self, script, *arguments):
        environment = {**os.environ, "PYTHONPATH": str(SIMULATORS)}
        done = subprocess.run(["/usr/bin/python3", "-B", str(HERE / script), *arguments],
                              cwd=self.folder, env=environment, capture_output=True, text=True,
                              timeout=250, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def fired(self, file):
        return in_order(*np.load(self.folder / file))

    def same(self, one, other, least):
        self.assertGreater(len(one[0]), least)
        self.assertGreater(len(np.unique(one[1])), 85)
        np.testing.assert_array_equal(one[0], other[0])
        np.testing.assert_array_equal(one[1], other[1])


class Brian2(Case):
    """Exact integration on one grid has no error but rounding: every spike is the same."""

    def test_exponential_currents_and_jumps_of_the_potential(self):
        drive = hundred_neurons.driving_spikes(DURATION_S)
        np.save(self.folder / "spikes.npy", np.stack(drive))
        least = {"iaf_psc_exp": 600, "iaf_psc_delta": 1200}
        # Once for both: it takes a second to import Brian2.
        self.elsewhere("hundred_in_brian.py", "spikes.npy", DURATION_MS, *least)
        for model, count in least.items():
            with self.subTest(model):
                self.same(self.own(model, drive, DURATION_S), self.fired(f"{model}.npy"), count)


class WithoutAGrid(Case):
    # Spikes alone make neurons fire: at sums of driving times and delays, which are whole numbers.
    QUIET = (("I_e: 300.0", "I_e: 0"), ("V_reset: -65.0", "V_reset: -70.0"),
             ("weight: 1,", "weight: 3,"))
    OFF = (("resolution: 0.1 ms", "resolution: off"),)
    FACTOR = 3

    def quiet(self):
        return {**hundred_neurons.PARAMETERS["iaf_psc_delta"], "I_e": 0.0, "V_reset": -70.0}

    def test_NEURON_and_the_event_driven_solution(self):
        drive = hundred_neurons.driving_spikes(DURATION_S)
        # NEURON takes what comes at one time one by one: with odd delays, excitation and inhibition
        # do not meet.
        odd = [(pre, post, round(delay_ms + more, 6)) for (pre, post, delay_ms), more in
               zip(hundred_neurons.PROJECTIONS,
                   (0.013127, 0.029741, 0.041233, 0.053897, 0.067411, 0.081919))]
        changes = tuple((f"from: {pre}, to: {post}, rule: {pre}_{post}.npy, weight: 3, delay: {old} ms",
                         f"from: {pre}, to: {post}, rule: {pre}_{post}.npy, weight: 3, delay: {new} ms")
                        for (pre, post, old), (_, _, new) in zip(hundred_neurons.PROJECTIONS, odd))
        own = self.own("iaf_psc_delta", drive, DURATION_S, self.QUIET + changes + self.OFF)
        self.same(own, solve(self.quiet(), self.FACTOR, *drive, float(DURATION_MS), odd), 250)
        np.save(self.folder / "spikes.npy", np.stack(drive))
        for variable in (False, True):
            (self.folder / "task.json").write_text(json.dumps(
                {"parameters": self.quiet(), "factor": self.FACTOR, "variable": variable,
                 "projections": odd}))
            self.elsewhere("hundred_in_neuron.py", "task.json", "spikes.npy", DURATION_MS, "fired.npy")
            self.same(own, self.fired("fired.npy"), 250)

    def test_a_grid_that_holds_every_event(self):
        # Driving spikes are in whole microseconds, delays in tenths of a millisecond.
        drive = hundred_neurons.driving_spikes(DURATION_S)
        off = self.own("iaf_psc_delta", drive, DURATION_S, self.QUIET + self.OFF)
        grid = self.own("iaf_psc_delta", drive, DURATION_S,
                        self.QUIET + (("resolution: 0.1 ms", "resolution: 1 us"),))
        self.same(off, grid, 250)

    def test_a_constant_current_against_the_event_driven_solution(self):
        drive = hundred_neurons.driving_spikes(DURATION_S)
        strong = (("I_e: 300.0", "I_e: 420.0"),)
        own = self.own("iaf_psc_delta", drive, DURATION_S, strong + self.OFF)
        parameters = {**hundred_neurons.PARAMETERS["iaf_psc_delta"], "I_e": 420.0}
        wanted = solve(parameters, 1, *drive, float(DURATION_MS))
        self.assertGreater(len(own[0]), 1500)
        on_events = np.isin(own[0] % 1000, 0).mean()
        self.assertLess(on_events, 0.9, "crossings between events were meant to happen")
        # A crossing is rounded up to 1 ns: the last digit of a logarithm may lead to the next one.
        for neuron in range(hundred_neurons.NEURONS):
            mine, theirs = (trains[0][trains[1] == neuron] for trains in (own, wanted))
            self.assertEqual(len(mine), len(theirs))
            self.assertLessEqual(np.abs(mine - theirs).max(initial=0), 20)

    def test_no_result_depends_on_the_tick(self):
        drive = hundred_neurons.driving_spikes(DURATION_S)
        changes = (("I_e: 300.0", "I_e: 420.0"),) + self.OFF
        runs = [self.own("iaf_psc_delta", drive, DURATION_S, changes, tick=tick)
                for tick in ("0.5 ms", "1 ms", "50 ms")]
        self.same(runs[1], runs[0], 1500)
        self.same(runs[1], runs[2], 1500)


if __name__ == "__main__":
    unittest.main()
