#!/usr/bin/python3
"""A script answers the robot's spikes in lockstep: five runs are the same to the bit, hesitating or
not; every spike comes back once, and reaches the nodes a tick later; a replay gives the same."""

import pathlib
import sys
import tempfile

import experiments
from experiments import runs

TICK = 10**6
DURATION_S = 2


def five_runs(scratch):
    file = experiments.explorer(scratch, "simulator: python\nscript: echo.py", sync="lockstep",
                                duration=f"{DURATION_S} s")
    prints = []
    for i in range(5):
        summary, _ = experiments.run(file, scratch / f"run{i}")
        prints.append(runs.fingerprint(scratch / f"run{i}"))
    assert len(set(prints)) == 1, prints
    assert summary["layout"] == "fused" and summary["sync"] == "lockstep", summary
    assert summary["collisions"] == 0 and summary["distance_m"] > 0.3, summary
    assert summary["simulated_s"] == DURATION_S, summary
    experiments.run(file, scratch / "other", "--seed", "2")
    assert runs.fingerprint(scratch / "other") != prints[0]
    return prints[0]


def every_spike_comes_back(scratch):
    sent = experiments.spikes(scratch / "run0", "encoder")
    assert sent.shape[1] > 600, sent.shape
    experiments.assert_same(sent, experiments.spikes(scratch / "run0", "brain"), "the answers")
    summary = runs.json.loads((scratch / "run0/summary.json").read_text())
    counters = summary["processes"]["experiment"]["counters"]
    in_time = experiments.delayed(sent, TICK, DURATION_S * 10**9).shape[1]
    assert counters["brain.out->decoder.in.spikes"] == in_time, counters
    assert counters["brain.out->decoder.in.late"] == 0, counters
    assert summary["spikes"] == in_time, summary


def hesitating(scratch, expected):
    file = scratch / "explorer.yaml"
    file.write_text(file.read_text().replace("script: echo.py",
                                             "script: echo.py\n    hesitating: true"))
    experiments.run(file, scratch / "hesitating")
    assert runs.fingerprint(scratch / "hesitating") == expected


def replayed(scratch):
    runs.spikeloop("replay", scratch / "run0", "--out", scratch / "again")
    experiments.assert_same(experiments.spikes(scratch / "run0", "brain"),
                            experiments.spikes(scratch / "again", "brain"), "the replay")


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        fingerprint = five_runs(scratch)
        every_spike_comes_back(scratch)
        hesitating(scratch, fingerprint)
        replayed(scratch)
    print("six runs with a script are the same to the bit")


if __name__ == "__main__":
    sys.exit(main())
