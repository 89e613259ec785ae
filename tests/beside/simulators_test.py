#!/usr/bin/python3
"""NEURON, in one process and in two, and Brian2 as nodes of an experiment: repeaters answer every spike as their rules say."""

import pathlib
import shutil
import sys
import tempfile

import numpy as np

import experiments

SIMULATORS = pathlib.Path(__file__).resolve().parents[1] / "simulators/scripts"
DURATION = 2 * 10**9
sys.path.insert(0, str(SIMULATORS.parent))


def repeat(scratch, simulator, script, expected, *keys):
    """A run with this script; its answers are what `expected` makes of what it was sent."""
    brain = "\n".join([f"simulator: {simulator}", f"script: {script}", *keys])
    file = experiments.explorer(scratch, brain, sync="lockstep", duration="2 s")
    shutil.copy(SIMULATORS / script, scratch)
    folder = scratch / simulator
    summary, _ = experiments.run(file, folder)
    sent = experiments.spikes(folder, "encoder")
    assert sent.shape[1] > 300, sent.shape
    experiments.assert_same(expected(sent), experiments.spikes(folder, "brain"), simulator)
    counters = summary["processes"]["experiment"]["counters"]
    assert counters["brain.out->decoder.in.late"] == 0, counters


def on_a_grid(sent, step, delay):
    """Times rounded up to steps, and later."""
    moved = np.stack([-(-sent[0] // step) * step + delay, sent[1]])
    moved = moved[:, moved[0] <= DURATION]
    return moved[:, np.lexsort((moved[1], moved[0]))]


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        repeat(scratch, "neuron", "repeat_neuron.py",
               lambda sent: experiments.delayed(sent, 2_500_000, DURATION), "delay: 2.5 ms")
        # Two processes: every spike crosses between them twice (repeat_neuron_parallel.py).
        repeat(scratch, "neuron", "repeat_neuron_parallel.py",
               lambda sent: experiments.delayed(sent, 3_500_000, DURATION), "np: 2")
        # A spike takes effect in the step that holds it, and the cell fires in the next one; no
        # encoder's neuron spikes twice in a step of 0.5 ms.
        repeat(scratch, "brian2", "repeat_brian.py",
               lambda sent: on_a_grid(sent, 500_000, 500_000))
    print("NEURON and Brian2 answer every spike")


if __name__ == "__main__":
    sys.exit(main())
