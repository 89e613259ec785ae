#!/usr/bin/python3
"""spikeloop.load: keys, runs, errors; the same run as by the command line."""

import os
import pathlib
import re
import signal
import subprocess
import sys
import time
import unittest

import numpy as np

import explorer
import spikeloop


class Interface(explorer.Folder):
    def setUp(self):
        super().setUp()
        self.experiment = spikeloop.load(self.file, {"sync": "lockstep", "duration": "1 s"})

    def test_keys_are_read_with_their_defaults_and_set(self):
        self.assertEqual(self.experiment["encoder.rate_max"], 200)
        self.assertEqual(self.experiment["decoder.tau"], 0.03)
        self.assertEqual(self.experiment["robot.world"], "arena.xml")
        self.assertEqual(self.experiment["sync"], "lockstep")
        self.experiment["encoder.rate_max"] = "100 Hz"
        self.experiment["robot.seed"] = 4
        self.experiment["wheels.limits"] = {"linear.x": [0, 0.5]}
        self.experiment["decoder.weights"] = np.zeros((2, 10))
        self.assertEqual(self.experiment["encoder.rate_max"], 100)
        self.assertEqual(self.experiment["robot.seed"], 4)
        self.assertIn("0.5", self.experiment["wheels.limits"])
        self.assertEqual(self.experiment["duration"], 1)
        self.assertEqual(self.experiment["encoder"]["node"], "rate_encoder")
        with self.assertRaises(KeyError):
            self.experiment["encoder.nothing"]
        self.experiment["encoder.ratemax"] = 3
        with self.assertRaisesRegex(spikeloop.SpikeloopError, "'ratemax'.* 'rate_max'"):
            self.experiment["seed"]
        del self.experiment["encoder.ratemax"]
        self.assertEqual(self.experiment["seed"], 1)

    def test_a_run_has_what_it_recorded(self):
        run = self.experiment.run(seed=3, set={"encoder.rate_max": "100 Hz"})
        spikes = run["encoder"].spikes
        self.assertEqual(len(spikes.times_s), run.counters()["encoder.spikes"])
        self.assertEqual(run["wheels"].signal.values.shape[1], 2)
        self.assertAlmostEqual(run.trajectory()["t_s"][-1], 1.0, places=1)
        self.assertEqual(run.summary()["seed"], 3)
        self.assertEqual(self.experiment["seed"], 1, "set for one run alone")
        folder = pathlib.Path(run.path)
        self.assertTrue(folder.exists())
        del run
        self.assertFalse(folder.exists(), "it goes with the result")

    def test_the_command_line_gives_the_same_spikes(self):
        run = self.experiment.run(seed=7, set={"encoder.rate_max": "150 Hz"}, out=self.folder / "a")
        out, said = explorer.spikeloop("run", "-q", self.file, "--sync", "lockstep", "--duration", "1 s", "--seed", 7,
                                       "--set", "encoder.rate_max=150 Hz", "--out", self.folder / "b")
        self.assertEqual((out, said), (f"{self.folder / 'b'}\n", ""))
        self.assertTrue(explorer.same(explorer.spikes_of_run(run.path), explorer.spikes_of_run(self.folder / "b")))

    def test_results_are_not_replaced_unless_forced(self):
        self.experiment.run(out=self.folder / "a")
        before = explorer.spikes_of_run(self.folder / "a")
        with self.assertRaisesRegex(spikeloop.SpikeloopError, f"{self.folder}/a.* --force") as caught:
            self.experiment.run(out=self.folder / "a", seed=2)
        self.assertEqual((caught.exception.code, caught.exception.exit_code), ("SL0109", 2))
        self.assertTrue(explorer.same(before, explorer.spikes_of_run(self.folder / "a")))
        self.experiment.run(out=self.folder / "a", seed=2, force=True)
        self.assertEqual(spikeloop.open_run(self.folder / "a").summary()["seed"], 2)
        with self.assertRaisesRegex(spikeloop.SpikeloopError, f"{self.folder}/nowhere"):
            spikeloop.open_run(self.folder / "nowhere")

    def test_errors_have_the_codes_of_diagnostics(self):
        for set_, code, text in (({"encoder.rate_max": "200 mV"}, "SL0202", "'mV' "),
                                 ({"encodr.rate_max": "1 Hz"}, "SL0301", "'encodr'.* 'encoder'")):
            with self.assertRaisesRegex(spikeloop.SpikeloopError, text) as caught:
                self.experiment.run(set=set_)
            self.assertEqual((caught.exception.code, caught.exception.exit_code), (code, 2))
        with self.assertRaisesRegex(spikeloop.SpikeloopError, "nowhere.yaml") as caught:
            spikeloop.load(self.folder / "nowhere.yaml")
        self.assertEqual((caught.exception.code, caught.exception.exit_code), ("SL0109", 4))

    def test_ctrl_c_stops_the_run_and_is_an_exception(self):
        script = ("import sys, spikeloop\n"
                  f"e = spikeloop.load({str(self.file)!r})\n"
                  "try:\n    e.run(duration='1000 s', out=sys.argv[1])\n"
                  "except KeyboardInterrupt:\n    print('stopped')\n")
        out = self.folder / "long"
        child = subprocess.Popen([sys.executable, "-c", script, out], stdout=subprocess.PIPE, text=True,
                                 start_new_session=True)
        while not (out / "encoder.h5").exists():
            time.sleep(0.02)
        os.killpg(child.pid, signal.SIGINT)
        self.assertEqual(child.communicate(timeout=60)[0], "stopped\n")
        out, _ = explorer.spikeloop("summary", out, out)
        self.assertIn("exit code", out)
        self.assertIn("130", out)

    def test_a_run_ends_with_the_process_that_started_it(self):
        script = f"import sys, spikeloop\nspikeloop.load({str(self.file)!r}).run(duration='1000 s', out=sys.argv[1])\n"
        out = self.folder / "long"
        child = subprocess.Popen([sys.executable, "-c", script, out], start_new_session=True)
        while not (out / "encoder.h5").exists():
            time.sleep(0.02)
        child.kill()
        child.wait()
        until = time.monotonic() + 60
        while not (out / "summary.json").exists() and time.monotonic() < until:
            time.sleep(0.05)
        self.assertIn("130", explorer.spikeloop("summary", out, out)[0])

    def test_a_text_stays_a_text(self):
        self.experiment["experiment"] = "3"
        self.assertEqual(self.experiment["experiment"], "3")
        for text in ("pilot #3: a", "[1, 2]", "~"):
            self.experiment["experiment"] = text
            with self.assertRaisesRegex(spikeloop.SpikeloopError, f"'{re.escape(text)}' .*SL0106"):
                self.experiment["seed"]

    def test_a_block_of_neo(self):
        try:
            import neo
        except ImportError:
            self.skipTest("python3-neo is not installed")
        run = self.experiment.run()
        block = run.neo_block()
        self.assertIsInstance(block, neo.Block)
        trains = [train for train in block.segments[0].spiketrains if train.name.startswith("encoder.out")]
        self.assertEqual(len(trains), 10)
        self.assertEqual(sum(map(len, trains)), run.counters()["encoder.spikes"])


if __name__ == "__main__":
    unittest.main()
