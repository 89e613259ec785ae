"""The experiment that `spikeloop new` prints, in a folder of a test's own."""

import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).parents[1] / "support"))
from calls import SPIKELOOP, assert_says, refused, spikeloop  # noqa: E402, F401
from folder import FolderCase  # noqa: E402
from recordings import same, spikes_of_run  # noqa: E402, F401

SCRIPT = """import spikeloop
with spikeloop.music(spikes_in={"in": 10}, spikes_out={"out": 10}) as host:
    for tick in host:
        times, channels = tick.spikes("in")
        tick.send("out", times, channels)
"""


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
