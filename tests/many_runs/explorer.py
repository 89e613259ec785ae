"""The experiment that `spikeloop new` prints, in a folder of a test's own."""

import os
import pathlib
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

PROGRAM = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"]) / "spikeloop"
SCRIPT = """import spikeloop
with spikeloop.music(spikes_in={"in": 10}, spikes_out={"out": 10}) as host:
    for tick in host:
        times, channels = tick.spikes("in")
        tick.send("out", times, channels)
"""


def spikeloop(*words, code=0, cwd=None, **options):
    """(standard output, standard error)"""
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, check=False, cwd=cwd,
                          timeout=120, **options)
    assert done.returncode == code, f"{words}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout, done.stderr


def recorded(folder):
    """Every spike of a run folder: times in ns and channels by file."""
    found = {}
    for path in sorted(pathlib.Path(folder).glob("*.h5")):
        with h5py.File(path) as file:
            for name, stream in file.get("spikes", {}).items():
                found[f"{path.stem}.{name}"] = (stream["timestamps_ns"][:], stream["node_ids"][:])
    return found


def same(first, second):
    return first.keys() == second.keys() and len(first) > 0 and all(
        np.array_equal(a, b) for name in first for a, b in zip(first[name], second[name]))


class Folder(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.file = self.folder / "explorer.yaml"
        self.file.write_text(spikeloop("new")[0])

    def with_script(self):
        """The same with a script in the network's place."""
        text = self.file.read_text()
        begin, end = text.index("  brain:"), text.index("  # Speed and turning rate")
        path = self.folder / "scripted.yaml"
        path.write_text(text[:begin] + "  brain: {simulator: python, script: brain.py}\n" + text[end:])
        (self.folder / "brain.py").write_text(SCRIPT)
        return path
