"""The experiment that `spikeloop new` prints, in a folder of a test's own."""

import pathlib
import sys

import h5py
import numpy as np

sys.path.append(str(pathlib.Path(__file__).parents[1] / "support"))
from calls import SPIKELOOP, assert_says, refused, spikeloop  # noqa: E402, F401
from folder import FolderCase  # noqa: E402

SCRIPT = """import spikeloop
with spikeloop.music(spikes_in={"in": 10}, spikes_out={"out": 10}) as host:
    for tick in host:
        times, channels = tick.spikes("in")
        tick.send("out", times, channels)
"""


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


class Folder(FolderCase):
    def setUp(self):
        super().setUp()
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
