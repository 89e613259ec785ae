"""Experiments with a simulator among their nodes, and what they leave; for the tests beside this file."""

import pathlib
import shutil
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "fused"))
import runs  # noqa: E402
from recordings import assert_same, in_order  # noqa: E402, F401
from runs import run  # noqa: E402, F401

BUILTIN = """\
    simulator: builtin
    network:
      populations:
        input: {model: input, size: 10}
        relay: {model: repeater, size: 10}
      connections:
        - {from: input, to: relay, rule: one_to_one, delay: 1 ms}
      output: [relay]
"""


def explorer(folder, brain, **keys):
    """What `spikeloop new` prints, with these lines in the built-in network's place."""
    file = runs.new_experiment(folder / "explorer.yaml", **keys)
    text = file.read_text()
    assert BUILTIN in text, text
    file.write_text(text.replace(BUILTIN, "".join(f"    {line}\n" for line in brain.splitlines())))
    for script in (HERE / "scripts").glob("*.py"):
        shutil.copy(script, folder)
    return file


def spikes(folder, node):
    """(times in ns, channels) of the output `out`, in order of time and channel."""
    return in_order(*runs.recordings.spikes(folder, node))


def delayed(found, by_ns, until_ns):
    """These spikes later, those that are later than the end of the run left out."""
    moved = found + np.array([[by_ns], [0]])
    return moved[:, moved[0] <= until_ns]
