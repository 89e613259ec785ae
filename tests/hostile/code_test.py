#!/usr/bin/python3
"""Code that a stranger's file names runs when `spikeloop check` may run it, and not with --no-code; a
module in the working directory, or beside the experiment, never takes the place of an installed one."""

import pathlib
import sys
import tempfile

from hostile import EXPERIMENT, NETWORK, Answer, programs

SPIKELOOP = programs() / "spikeloop"
SPY = "import pathlib\npathlib.Path({!r}).touch()\n"
BRAIN = """import numpy
from spikeloop.network import *
def make():
    raise RuntimeError("numpy is of " + numpy.__file__)
"""
MUSIC = """stoptime=1
[a]
np=1
binary=spikeloop-node
node=gain
plugin=plugin.py
[b]
np=1
binary=spikeloop-network
network=brain.py
[c]
np=1
binary=linear_readout_decoder
tauu=3
a.out -> b.in [3]
b.out -> c.in [3]
"""


def main():
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        ran = folder / "ran"
        for name in ("numpy.py", "plugin.py", "brain.py", "json.py", "h5py.py", "nest.py"):
            (folder / name).write_text(SPY.format(str(ran)))
        text = EXPERIMENT.replace("node: spike_playback, file: FILE", "node: network, network: brain.py")
        (folder / "it.yaml").write_text("plugins: [plugin.py]\n" + text)
        (folder / "it.music").write_text(MUSIC)
        answer = Answer(SPIKELOOP, "check", "--no-code", "it.yaml", cwd=folder)
        for word in ("plug-in 'plugin.py' is code", "brain.py' is code", "connections are not checked",
                     "0 errors, 3 warnings"):
            assert word in answer.text, answer.text
        answer = Answer(SPIKELOOP, "check", "--no-code", "it.music", cwd=folder)
        assert "tauu" in answer.text, answer.text
        for word in ("plugin.py' is code", "brain.py' is code"):
            assert word in answer.text, answer.text
        for words in (["graph", "--no-code"], ["export", "--out", "job", "--no-code"]):
            answer = Answer(SPIKELOOP, *words, "it.yaml", cwd=folder)
            answer.refused("plug-in 'plugin.py' is code", "it.yaml is not processed", "leave out --no-code")
            assert answer.code == 2, answer.text
        answer = Answer(SPIKELOOP, "export", "--no-code", "it.music", cwd=folder)
        assert "brain.py' is code" in answer.text, answer.text
        assert not ran.exists() and not (folder / "job").exists(), "code has run"
        (folder / "it.yaml").write_text(text)
        answer = Answer(SPIKELOOP, "check", "--no-code", "it.yaml", cwd=folder)
        assert answer.code == 0 and "0 errors, 2 warnings" in answer.text, answer.text
        answer = Answer(SPIKELOOP, "check", "--no-code", "--strict", "it.yaml", cwd=folder)
        assert answer.code == 2 and "0 errors, 2 warnings" in answer.text, answer.text
        (folder / "brain.py").write_text(BRAIN)
        answer = Answer(SPIKELOOP, "check", "it.yaml", cwd=folder)
        answer.refused("numpy is of /usr/lib")
        assert not ran.exists(), "a module in the working directory has run"
        (folder / "net.yaml").write_text(NETWORK)
        (folder / "sim.yaml").write_text(text.replace("node: network, network: brain.py",
                                                      "simulator: nest, network: net.yaml"))
        Answer(SPIKELOOP, "check", "sim.yaml", cwd=folder)
        Answer(SPIKELOOP, "doctor", cwd=folder)
        assert not ran.exists(), "a module in the working directory has run"
        Answer(SPIKELOOP, "check", "it.yaml", "--strict", cwd=folder)
    print("code runs only when it may")


if __name__ == "__main__":
    sys.exit(main())
