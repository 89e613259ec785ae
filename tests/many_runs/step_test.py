#!/usr/bin/python3
"""Experiment.open: a run, tick by tick, and the caller in a simulator's place."""

import os
import signal
import threading
import time
import unittest

import numpy as np

import explorer
import spikeloop


class Stepped(explorer.Folder):
    def test_it_is_the_same_run(self):
        experiment = spikeloop.load(self.file, {"sync": "lockstep", "duration": "1 s"})
        whole, times = experiment.run(), []
        with experiment.open() as loop:
            self.assertEqual(loop.tick_s, 0.001)
            self.assertEqual(loop.outputs["encoder.out"], ("spikes", 10))
            self.assertIsNone(loop.signal("scan.out"))
            while loop.step(30):  # the last block is shorter
                times.append(loop.spikes("encoder.out")[0])
            self.assertAlmostEqual(loop.time_s, 1.0)
            self.assertEqual(loop.signal("wheels.command").shape, (2,))
            self.assertEqual(loop.signal("scan.out").shape, (100,))
        np.testing.assert_array_equal(np.sort(np.concatenate(times)), np.sort(whole["encoder"].spikes.times_s))
        for key in ("distance_m", "spikes", "commands", "counters"):
            self.assertEqual(loop.summary()[key], whole.summary()[key], key)

    def test_a_caller_who_repeats_spikes_is_a_script_that_does(self):
        experiment = spikeloop.load(self.with_script(), {"sync": "lockstep", "duration": "1 s"})
        by_script = experiment.run()
        with experiment.open(out=self.folder / "by_hand") as loop:
            self.assertEqual(loop.inputs, {"brain.out": ("spikes", 10)})
            while loop.step():
                loop.send("brain.out", *loop.spikes("brain.in"))
        by_hand = loop.run()
        for node in ("scan", "sectors", "decoder"):
            np.testing.assert_array_equal(by_hand[node].signal.values, by_script[node].signal.values)
        np.testing.assert_array_equal(by_hand["encoder"].spikes.times_s, by_script["encoder"].spikes.times_s)
        self.assertGreater(by_hand["decoder"].signal.values.max(), 0)
        self.assertFalse(loop.step(), "it has ended")
        for command in ("replay", "run"):
            explorer.refused('a program in Python stood for its simulators, ["brain"]', command, self.folder / "by_hand")

    def test_one_thread_at_a_time(self):
        experiment = spikeloop.load(self.file, {"sync": "realtime", "duration": "30 s"})
        with experiment.open() as loop:
            other = threading.Thread(target=loop.step, args=(2000,))
            other.start()
            while loop.time_s == 0:
                time.sleep(0.01)
            with self.assertRaisesRegex(spikeloop.SpikeloopError, "another thread uses this loop"):
                loop.step()
            other.join()
            self.assertTrue(loop.step())

    def test_ctrl_c_comes_through(self):
        experiment = spikeloop.load(self.file, {"sync": "realtime", "duration": "1000 s"})
        with experiment.open() as loop, self.assertRaises(KeyboardInterrupt):
            threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
            loop.step(1_000_000)
        self.assertLess(loop.time_s, 900)

    def test_mistakes(self):
        experiment = spikeloop.load(self.with_script(), {"sync": "lockstep", "duration": "1 s"})
        with experiment.open() as loop:
            loop.step(3)
            for wrong, text in ((lambda: loop.send("brain.out", [0.5], [0]), "is not in the last tick, "),
                                (lambda: loop.send("brain.out", [0.003], [10]), "no channel 10; write one from 0 to 9"),
                                (lambda: loop.send("brain.out", [0.003], [0, 1]), "1 times and 2 channels"),
                                (lambda: loop.send("brain.out", [0.003], [1.5]), "write finite times and whole numbers"),
                                (lambda: loop.send("brain.out", [np.nan], [1]), "write finite times and whole numbers"),
                                (lambda: loop.send("brian.out", [], []), "did you mean 'brain.out'"),
                                (lambda: loop.write("brain.out", [1]), "carries spikes; write loop.send"),
                                (lambda: loop.signal("encoder.out"), "carries spikes; write loop.spikes"),
                                (lambda: loop.spikes("encoder.in"), "there is no output of a node")):
                with self.assertRaisesRegex(spikeloop.SpikeloopError, text):
                    wrong()
        for settings, text in (({"ros": 2}, "leave out  ros: 2"), ({"encoder.rate_max": "1 mV"}, "'mV' .*SL0202")):
            with self.assertRaisesRegex(spikeloop.SpikeloopError, text):
                experiment.open(set=settings)

    def test_nodes_in_python_and_what_fails_in_a_tick(self):
        (self.folder / "relay.py").write_text(
            "import spikeloop\n"
            "@spikeloop.node(inputs={'in': 'signal'}, outputs={'out': spikeloop.Signal(same_as='in')}, fail=False)\n"
            "def relay(step, fail):\n"
            "    'Copies'\n"
            "    if fail:\n"
            "        raise RuntimeError('broken')\n"
            "    if step.changed('in'):\n"
            "        step.write('out', step.inputs['in'])\n")
        text = self.file.read_text().replace("experiment: explorer", "experiment: explorer\nplugins: [relay.py]")
        text = text.replace("nodes:\n", "nodes:\n  copy: {node: relay}\n", 1)
        self.file.write_text(text.replace("-> sectors", "-> copy -> sectors"))
        experiment = spikeloop.load(self.file, {"sync": "lockstep", "duration": "1 s"})
        with experiment.open() as loop:
            loop.step(100)
            np.testing.assert_array_equal(loop.signal("copy.out"), loop.signal("scan.out"))
        with self.assertRaisesRegex(spikeloop.SpikeloopError, "RuntimeError: broken") as caught:
            with experiment.open(set={"copy.fail": "true"}) as loop:
                loop.step()
        self.assertEqual((caught.exception.code, caught.exception.exit_code), ("SL0704", 5))


if __name__ == "__main__":
    unittest.main()
