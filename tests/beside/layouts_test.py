#!/usr/bin/python3
"""The same delays and recorded input give the same spikes in every layout with a simulator in
between, and those that its rules say: of a script (spikes and continuous values), and of NEURON."""

import itertools
import pathlib
import shutil
import sys
import tempfile

import experiments
import numpy as np

SIMULATORS = pathlib.Path(__file__).resolve().parents[1] / "simulators/scripts"
DURATION = 500_000_000
HEAD = """\
experiment: both
duration: 500 ms
tick: {tick_us} us
sync: unpaced
plugins: [pass_on.py]
nodes:
  beams: {{node: spike_playback, file: recorded/encoder.h5}}
  level: {{node: signal_playback, file: recorded/sectors.h5}}
"""
SCRIPT = HEAD + """\
  brain: {{simulator: python, script: half.py}}
  came: {{node: pass_on}}
  other: {{node: pass_on}}
  encoder: {{node: rate_encoder, rate_max: 150 Hz}}
layout: {{one: [beams, level, came], two: [other, encoder]}}
connections:
  - beams -> brain [10, delay 2 ticks] -> came [10, delay 3 ticks]
  - brain.out -> other [10, delay 1 tick]
  - level -> brain.level [10, delay 4 ticks]
  - brain.half -> encoder [10, delay 5 ticks]
"""
ALONE = HEAD.replace("  beams: {{node: spike_playback, file: recorded/encoder.h5}}\n", "") + """\
  half: {{node: connect, weights: "one_to_one:0.5"}}
  encoder: {{node: rate_encoder, rate_max: 150 Hz}}
connections:
  - level -> half [10, delay 4 ticks] -> encoder [10, delay 5 ticks]
"""
CELLS = HEAD + """\
  brain: {{simulator: neuron, script: repeat_neuron.py, delay: 2.5 ms}}
  came: {{node: pass_on}}
  encoder: {{node: rate_encoder, rate_max: 150 Hz}}
layout: {{one: [beams], two: [level, encoder, came]}}
connections:
  - beams -> brain [10, delay 1 tick] -> came [10, delay 2 ticks]
  - level -> encoder
"""
# Two scripts, one behind the other, and back: a cycle of three processes.
CHAIN = HEAD + """\
  first: {{simulator: python, script: echo.py}}
  second: {{simulator: python, script: echo.py}}
  came: {{node: pass_on}}
  encoder: {{node: rate_encoder, rate_max: 150 Hz}}
layout: {{one: [beams], two: [level, encoder, came]}}
connections:
  - beams -> first [10, delay 1 tick] -> second [10, delay 2 ticks] -> came [10, delay 1 tick]
  - level -> encoder
"""
# Inputs of scripts and nodes that take parts of outputs, and several of them; nodes that are not recorded.
PARTS = HEAD + """\
  brain: {{simulator: python, script: echo.py}}
  silent: {{simulator: python, script: echo.py, record: false}}
  came: {{node: pass_on}}
  other: {{node: pass_on, record: false}}
  encoder: {{node: rate_encoder, rate_max: 150 Hz}}
layout: {{one: [beams], two: [level, encoder, came, other]}}
connections:
  - beams[5:], beams -> brain [15, delay 1 tick]
  - brain -> silent [15, delay 1 tick]
  - brain[3:6] + beams[7:] -> came [3, delay 2 ticks]
  - silent -> other [15]
  - level -> encoder
"""


def written(scratch, name, text, tick_us):
    file = scratch / f"{name}.yaml"
    file.write_text(text.format(tick_us=tick_us))
    return file


def every_layout(scratch, name, text, ticks_us):
    """A run in each: its folder, and the tick in ns. The ticks (us) alternate."""
    for layout, tick_us in zip(("fused", "separate", "processes"), itertools.cycle(ticks_us)):
        folder = scratch / f"{name}-{tick_us}-{layout}"
        experiments.run(written(scratch, name, text, tick_us), folder,
                        *(() if layout == "processes" else ("--layout", layout)))
        yield folder, tick_us * 1000


def check(folder, node, expected):
    experiments.assert_same(expected, experiments.spikes(folder, node), f"{folder.name}, {node}")


def script(scratch, beams, ticks_us):
    alone = {}
    for tick_us in ticks_us:
        folder = scratch / f"alone-{tick_us}"
        experiments.run(written(scratch, "alone", ALONE, tick_us), folder)
        alone[tick_us * 1000] = experiments.spikes(folder, "encoder")
    for folder, tick in every_layout(scratch, "script", SCRIPT, ticks_us):
        answers = experiments.delayed(beams, 2 * tick, DURATION)
        check(folder, "brain", answers)
        check(folder, "came", experiments.delayed(answers, 3 * tick, DURATION))
        check(folder, "other", experiments.delayed(answers, tick, DURATION))
        check(folder, "encoder", alone[tick])


def cells(scratch, beams, ticks_us):
    for folder, tick in every_layout(scratch, "cells", CELLS, ticks_us):
        answers = experiments.delayed(beams, tick + 2_500_000, DURATION)
        check(folder, "brain", answers)
        check(folder, "came", experiments.delayed(answers, 2 * tick, DURATION))


def chain(scratch, beams, ticks_us):
    for folder, tick in every_layout(scratch, "chain", CHAIN, ticks_us):
        check(folder, "first", experiments.delayed(beams, tick, DURATION))
        check(folder, "second", experiments.delayed(beams, 3 * tick, DURATION))
        check(folder, "came", experiments.delayed(beams, 4 * tick, DURATION))


def channels(found, first, end, at=0):
    """The spikes of these channels, which become those from `at` on."""
    inside = (found[1] >= first) & (found[1] < end)
    return found[:, inside] + np.array([[0], [at - first]])


def merged(*trains):
    both = np.concatenate(trains, axis=1)
    return both[:, np.lexsort((both[1], both[0]))]


def parts(scratch, beams, ticks_us):
    for folder, tick in every_layout(scratch, "parts", PARTS, ticks_us):
        answers = experiments.delayed(merged(channels(beams, 5, 10), channels(beams, 0, 10, 5)), tick, DURATION)
        check(folder, "brain", answers)
        check(folder, "came", experiments.delayed(
            merged(channels(answers, 3, 6), channels(beams, 7, 10)), 2 * tick, DURATION))
        recorded = sorted(file.stem for file in folder.glob("*.h5"))
        assert recorded == ["beams", "brain", "came", "encoder", "level"], recorded
    replayed = folder.parent / f"{folder.name}-again"  # in several processes
    experiments.runs.spikeloop("replay", "-q", folder, "--out", replayed)
    assert sorted(file.stem for file in replayed.glob("*.h5")) == recorded


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        file = experiments.explorer(scratch, experiments.BUILTIN.replace("    ", "", 1).replace(
            "\n    ", "\n"), sync="lockstep", duration="500 ms")
        shutil.copy(SIMULATORS / "repeat_neuron.py", scratch)
        experiments.run(file, scratch / "recorded")
        beams = experiments.spikes(scratch / "recorded", "encoder")
        assert beams.shape[1] > 75, beams.shape
        # A delay is a number of ticks, whatever their length, but cells of NEURON have delays in ms, and a script sees
        # the times of spikes in a tick: every text has both ticks, and so has every layout.
        for test, ticks_us in ((script, (1000, 5000)), (cells, (5000, 1000)), (chain, (1000, 5000)), (parts, (5000, 1000))):
            test(scratch, beams, ticks_us)
    print("all layouts give the spikes that the delays say")


if __name__ == "__main__":
    sys.exit(main())
