#!/usr/bin/python3
"""Connections with several senders and with slices, in every layout, against numpy.

    senders_test.py --spikeloop build/release/bin/spikeloop

The senders are recorded, and so are nodes that pass on what they receive: `disturb_spikes` that disturbs
nothing, `clip` with wide bounds.
"""

import argparse
import pathlib
import sys
import tempfile

import h5py
import numpy as np
from random_graphs import DURATION_S, record_drive, run, spikes_of

DELAY_NS = 3_000_000  # of all connections, and what a process in a cycle needs
EXPERIMENT = """duration: {duration} s
sync: unpaced
layout: {{one: [scan, left, sum], two: [speed, right, row, few], three: [many, merged, part]}}
nodes:
  scan: {{node: signal_playback, file: {drive}/scan.h5}}
  speed: {{node: signal_playback, file: {drive}/decoder.h5}}
  left: {{node: rate_encoder, rate_max: 90 Hz}}
  right: {{node: poisson_encoder, rate_max: 90 Hz}}
  row: {{node: clip, min: -1000, max: 1000}}
  sum: {{node: clip, min: -1000, max: 1000}}
  many: {{node: disturb_spikes}}
  merged: {{node: disturb_spikes}}
  part: {{node: clip, min: -1000, max: 1000}}
  few: {{node: disturb_spikes}}
connections:
  - scan[98:], speed[0] -> part [3, delay 3 ticks]
  - right[1], left[0:2] -> few [delay 3 ms]
  - speed -> left [2, delay 3 ticks]
  - speed -> right [2, delay 3 ticks]
  - speed, scan, speed -> row [104, delay 3 ticks]
  - {{from: speed + speed, to: sum, delay: 3 ticks}}
  - {{from: [left, right, left], to: many, delay: 3 ms}}
  - left + right -> merged [2, delay 3 ms]
"""
# What the connections above say, in numpy.
ROWS = {
    "row": lambda of: np.hstack([of["speed"], of["scan"], of["speed"]]),
    "sum": lambda of: of["speed"] + of["speed"],
    "part": lambda of: np.hstack([of["scan"][:, 98:], of["speed"][:, :1]]),
}
TRAINS = {
    "many": lambda of: [moved(of["left.out"], 0), moved(of["right.out"], 2), moved(of["left.out"], 4)],
    "merged": lambda of: [of["left.out"], of["right.out"]],
    "few": lambda of: [moved(of["right.out"], 0, 1, 2), moved(of["left.out"], 1, 0, 2)],
}


def moved(train, by, first=0, end=None):
    """The channels [first, end) of a train, as those from `by` on."""
    times, channels = train
    inside = (channels >= first) & (channels < (end or np.inf))
    return times[inside], channels[inside] - first + by


def merge(trains):
    """One train of several, without what is still on its way at the end."""
    times = np.concatenate([times for times, _ in trains]) + DELAY_NS
    channels = np.concatenate([channels for _, channels in trains])
    here = times <= round(DURATION_S * 1e9)
    times, channels = times[here], channels[here]
    order = np.lexsort((channels, times))
    return times[order], channels[order]


def signals_of(folder):
    """The held values of every recorded signal in each of its ticks; NaN before the first one."""
    ticks = np.arange(1, round(DURATION_S * 1e3) + 1) * 1_000_000
    signals = {}
    for path in pathlib.Path(folder).glob("*.h5"):
        with h5py.File(path) as file:
            for group in file.get("signals", {}).values():
                times, values = group["times_ns"][:], group["values"][:]
                row = np.searchsorted(times, ticks, side="right") - 1
                signals[path.stem] = np.where((row >= 0)[:, None], values[row], np.nan)
    return signals


def compare(folder, layout):
    """The number of values and spikes that are as expected; exits when one is not."""
    signals, trains = signals_of(folder), spikes_of(folder)
    for name, expected_of in ROWS.items():
        expected, seen = expected_of(signals)[:-3], signals[name][3:]
        if not np.isfinite(expected).any() or not np.array_equal(expected, seen, equal_nan=True):
            sys.exit(f"{layout}: '{name}' is not what its senders give three ticks later")
    for name, expected_of in TRAINS.items():
        times, channels = merge(expected_of(trains))
        seen_times, seen_channels = trains[f"{name}.out"]
        if not len(times) or not np.array_equal(channels, seen_channels) or np.abs(times - seen_times).max() > 1:
            sys.exit(f"{layout}: '{name}' has not the {len(times)} spikes of its senders")
    return sum(len(trains[f"{name}.out"][0]) for name in TRAINS)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--spikeloop", default="build/release/bin/spikeloop")
    program = str(pathlib.Path(parser.parse_args().spikeloop).resolve())
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        text = EXPERIMENT.format(duration=DURATION_S, drive=record_drive(program, scratch))
        path = scratch / "senders.yaml"
        path.write_text(text)
        for layout, options in (("fused", ("--layout", "fused")), ("separate", ("--layout", "separate")),
                                ("processes", ())):
            run(program, str(path), *options, "--out", str(scratch / layout), text=text)
            print(f"{layout}: {compare(scratch / layout, layout)} spikes")


if __name__ == "__main__":
    main()
