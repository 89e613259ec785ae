#!/usr/bin/python3
"""Ctrl-C: nothing is lost, nothing is left running; the same command goes on."""

import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from bench_program import SPIKELOOP, results


def children_of(pid):
    """All descendants, by /proc."""
    found = []
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[1]) == pid:
            child = int(stat.parent.name)
            found += [child, *children_of(child)]
    return found


def alive(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


class Stopping(unittest.TestCase):
    def stopped(self, number, layout, code):
        """Sends the signal while the second trial of a long run goes on."""
        with tempfile.TemporaryDirectory() as name:
            out = pathlib.Path(name) / "out"
            command = [SPIKELOOP, "bench", "--part", "b", "--layouts", layout, "--rates", "2,5000",
                       "--neurons", "200", "--trials", "1", "--duration", "500", "--limit", "900",
                       "--out", str(out)]
            process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                       text=True)
            try:
                for line in process.stderr:
                    if "at 5000 Hz" in line:
                        break
                while not children_of(process.pid):
                    self.assertIsNone(process.poll())
                    time.sleep(0.1)
                time.sleep(1.5)
                helpers = children_of(process.pid)
                self.assertTrue(helpers)
                process.send_signal(number)
                said, error = process.communicate(timeout=60)
            finally:
                process.kill()
                process.communicate()
            self.assertEqual(process.returncode, code, error)
            name = signal.Signals(number).name
            self.assertEqual(error.splitlines()[-1],
                             f"spikeloop: stopped by {name}; what was measured is in {out}/results.json, "
                             "and the same command goes on from there")
            trials = {point["rate_max_hz"]: len(point["trials"]) for point in results(out)["points"]}
            self.assertEqual(trials.get(2), 1)
            self.assertEqual(trials.get(5000, 0), 0)
            self.assertTrue((out / "b.png").exists())
            self.assertTrue(re.search("rate of 200 neurons in real time, .* 2 Hz", said), said)
            self.assertEqual([pid for pid in helpers if alive(pid)], [])

    def test_ctrl_c_fused(self):
        self.stopped(signal.SIGINT, "fused", 130)

    def test_ctrl_c_separate(self):
        self.stopped(signal.SIGINT, "separate", 130)

    def test_sigterm(self):
        self.stopped(signal.SIGTERM, "fused", 143)


if __name__ == "__main__":
    sys.exit(unittest.main())
