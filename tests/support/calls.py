"""Calls of `spikeloop` as a user types them, and what it says."""

import os
import pathlib
import re
import subprocess

SPIKELOOP = str(pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"]) / "spikeloop")

# Two programs under mpirun, without a robot.
TWO_PROGRAMS = """experiment: cycle
duration: 0.1 s
sync: unpaced
layout: {one: [squash, encoder], two: [decoder]}
nodes:
  squash: {node: sigmoid}
  encoder: {node: rate_encoder}
  decoder: {node: linear_readout, weights: uniform}
connections:
  - squash -> encoder [1] -> decoder [1] -> squash [1, delay 5 ticks]
"""


def spikeloop(*words, code=0, timeout=240, **options):
    """(standard output, standard error)"""
    done = subprocess.run([SPIKELOOP, *map(str, words)], capture_output=True, text=True, check=False, timeout=timeout,
                          **options)
    assert done.returncode == code, f"{words}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout, done.stderr


def _whole(piece):
    """Not as a part of a longer word or number."""
    begin, end = r"(?<![\w.-])" if piece[0].isalnum() else "", r"(?!\w|\.\w)" if piece[-1].isalnum() else ""
    return begin + re.escape(piece) + end


def assert_says(printed, *expected):
    """A line of what is printed has each text; in a text, ` ... ` stands for wording, which another test checks."""
    for text in expected:
        pattern = ".*".join(map(_whole, text.split(" ... ")))
        assert re.search(pattern, printed), f"expected:\n{text}\nprinted:\n{printed}"


def refused(expected, *words, code=2, **options):
    """The call ends with this code, and standard error says what is expected."""
    assert_says(spikeloop(*words, code=code, **options)[1], expected)
