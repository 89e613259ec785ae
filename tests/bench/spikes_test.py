"""Is what is measured the right thing? Spikes of real runs against theory, and what is said of others."""

import json
import os
import pathlib
import subprocess
import tempfile
import time
import unittest

import numpy as np

from spikeloop.bench import chain, results, sweeps, trial

PROGRAMS = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])


def setting(layout="fused", encoder="rate", simulator="none", tick_ms=50.0, neurons=200,
            rates=(1.0, 2.0), duration_s=1.0):
    return chain.Setting(layout, encoder, simulator, tick_ms, neurons, *rates, duration_s)


def integral(rates, tick_ms, duration_s, hops):
    """By steps of 0.1 ms: the mean of the beams, a wave of a quarter of a period over 100 beams."""
    total = 0.0
    for k in range(round(duration_s * 1e4)):
        end_of_tick = (np.floor(k / 10 / tick_ms + 1e-9) + 1 - hops) * tick_ms
        if end_of_tick <= 0:
            continue  # nothing has arrived
        scan_s = np.floor(end_of_tick / 50 + 1e-9) * 0.05
        beams = 0.9 * np.sin(2 * np.pi * (0.37 * scan_s + np.arange(100) / 400))
        total += 1e-4 * (rates[0] + (np.mean(beams) + 1) / 2 * (rates[1] - rates[0]))
    return total


class Expectation(unittest.TestCase):
    def test_integral(self):
        for layout, hops in (("fused", 0), ("separate", 2)):
            for tick_ms in (50.0, 10.0, 1.0):
                with self.subTest(layout=layout, tick_ms=tick_ms):
                    given = setting(layout, tick_ms=tick_ms, rates=(3.0, 20.0), duration_s=0.5)
                    self.assertAlmostEqual(chain.expected_spikes_a_neuron(given),
                                           integral((3.0, 20.0), tick_ms, 0.5, hops), places=9)


class RealRuns(unittest.TestCase):
    """Counted by the programs themselves; run() refuses others."""

    def measured(self, **keys):
        given = setting(**keys)
        return given, trial.run(PROGRAMS, given, 60)

    def test_rate_neurons_fire_once_an_integral_of_one(self):
        for layout in ("fused", "separate"):
            for tick_ms in (50.0, 5.0):
                with self.subTest(layout=layout, tick_ms=tick_ms):
                    given, result = self.measured(layout=layout, tick_ms=tick_ms, rates=(5.0, 40.0),
                                                  neurons=30, duration_s=2.0)
                    hops = 2 if layout == "separate" else 0
                    whole = np.floor(integral((5.0, 40.0), tick_ms, 2.0, hops))
                    self.assertEqual(result["spikes"], 30 * whole)
                    self.assertGreater(result["run_s"], 0)
                    self.assertGreater(result["build_s"], 0)
                    self.assertAlmostEqual(result["real_time_factor"] * result["run_s"], 2.0, 3)

    def test_poisson_neurons_fire_as_often_on_average(self):
        given, result = self.measured(encoder="poisson", rates=(20.0, 60.0), neurons=2000)
        expected = 2000 * integral((20.0, 60.0), 50.0, 1.0, 0)
        self.assertLess(abs(result["spikes"] - expected), 6 * np.sqrt(expected))

    def test_nef_neurons_fire(self):
        for layout in ("fused", "separate"):
            _, result = self.measured(layout=layout, encoder="nef", neurons=1000)
            self.assertGreater(result["spikes"], 1000)

    def test_simulators_give_back_every_spike_but_the_last(self):
        for simulator in ("builtin", "neuron"):
            with self.subTest(simulator=simulator):
                _, result = self.measured(layout="separate", simulator=simulator, neurons=50,
                                          rates=(50.0, 50.0), duration_s=1.0)
                # 50 Hz from 0.1 s on; a spike every 20 ms; of the last 100 ms some may be held.
                self.assertLessEqual(result["spikes"], 50 * 45)
                self.assertGreaterEqual(result["spikes"], 50 * 40)

    def test_a_slow_run_is_stopped(self):
        """As far as it came in that time, with the factor of what it did."""
        given = setting(neurons=20_000, rates=(500.0, 500.0), duration_s=10_000.0)
        result = trial.run(PROGRAMS, given, 0.5)
        self.assertTrue(result["stopped"])
        self.assertIsNone(result["spikes"])
        self.assertLess(result["real_time_factor"], 10_000 / 0.5)

    def test_a_run_that_fails_says_why(self):
        given = setting(neurons=20_000_000)  # more than a port takes
        with self.assertRaisesRegex(trial.TrialError, "20000000"):
            trial.run(PROGRAMS, given, 60)


class NoProgram(unittest.TestCase):
    def test_is_told(self):
        with self.assertRaisesRegex(trial.TrialError, "^cannot start '/nowhere/spikeloop': "):
            trial.run(pathlib.Path("/nowhere"), setting(), 60)


class OutOfTime(unittest.TestCase):
    def test_what_is_left_is_told_and_no_failure(self):
        with tempfile.TemporaryDirectory() as name:
            kept = results.Results(pathlib.Path(name), {"duration_s": 100.0})
            plan = sweeps.Plan(layouts=["fused"], simulators=["none"], encoders=["rate"],
                               ticks_ms=[50], rates_hz=[8000], trials=1, steps=1, neurons=1000,
                               least=1000, most=1000, duration_s=100.0, limit_s=60)
            work = sweeps.Sweeps(PROGRAMS, plan, kept, lambda text: None)
            work.deadline = time.monotonic() + 1
            work.part_b()
            work.part_a()
            told = [(entry["rate_max_hz"], entry["reason"], entry["failed"])
                    for entry in kept.not_measured]
        self.assertEqual(told, [(8000, "out of time", False), (2, "out of time", False)])


class Refusals(unittest.TestCase):
    def test_numbers_of_spikes_that_theory_does_not_have(self):
        given = setting(neurons=100, rates=(10.0, 10.0), duration_s=2.0)  # 20 spikes each
        trial.check_spikes(given, 2000, 2000)
        for encoded, decoded, said in (
                (2200, 2200, "the encoder sent 2200 spikes, but its rate's integral is 2000"),
                (1800, 1800, "the encoder sent 1800 spikes, but its rate's integral is 2000"),
                (2000, 1999, "2000 spikes were encoded, but 1999 reached the decoder"),
                (2000, 2001, "2000 spikes were encoded, but 2001 reached the decoder")):
            with self.subTest(encoded=encoded, decoded=decoded):
                with self.assertRaisesRegex(trial.TrialError, f"^{said}$"):
                    trial.check_spikes(given, encoded, decoded)
        silent = setting(encoder="nef")
        with self.assertRaisesRegex(trial.TrialError, "^0 spikes were encoded, but 0 reached"):
            trial.check_spikes(silent, 0, 0)

    def test_a_simulator_may_hold_what_came_within_its_delay(self):
        given = setting("separate", simulator="builtin", neurons=100, rates=(10.0, 10.0),
                        duration_s=2.0)
        trial.check_spikes(given, 1900, 1750)
        with self.assertRaisesRegex(trial.TrialError, "1900 spikes were encoded, but 1500 reached"):
            trial.check_spikes(given, 1900, 1500)


class Files(unittest.TestCase):
    def test_what_is_run_is_valid_in_both_layouts(self):
        for layout in ("fused", "separate"):
            for encoder in chain.ENCODERS:
                for simulator in ("none", "builtin"):
                    with self.subTest(layout=layout, encoder=encoder, simulator=simulator), \
                            tempfile.TemporaryDirectory() as name:
                        folder = pathlib.Path(name)
                        file = chain.write(setting(layout, encoder, simulator), folder)
                        done = subprocess.run([PROGRAMS / "spikeloop", "check", file], cwd=folder,
                                              capture_output=True, text=True, check=False)
                        self.assertEqual(done.returncode, 0, done.stderr)
                        self.assertNotIn("warning", done.stdout + done.stderr)

    def test_nef_inputs_are_means_of_all_beams(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            chain.write(setting(encoder="nef"), folder)
            weights = np.array(json.loads((folder / "beams.json").read_text()))
        self.assertEqual(weights.shape, (16, 100))
        np.testing.assert_allclose(weights.sum(axis=1), 1)
        self.assertTrue(np.all((weights > 0).sum(axis=0) == 1))


if __name__ == "__main__":
    unittest.main()
