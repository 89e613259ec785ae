#!/usr/bin/python3
"""In lockstep a run can be repeated to the bit; another seed is another run; a replay of the
recorded sensor gives the same spikes. In real time a run that is asked for too much says what it can do."""

import pathlib
import re
import sys
import tempfile

import h5py
import numpy as np

import runs


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        file = runs.new_experiment(scratch / "explorer.yaml", sync="lockstep", duration="20 s")
        prints = []
        for i in range(5):
            summary, _ = runs.run(file, scratch / f"run{i}")
            prints.append(runs.fingerprint(scratch / f"run{i}"))
        assert len(set(prints)) == 1, prints
        assert summary["collisions"] == 0 and summary["distance_m"] > 3, summary
        assert summary["simulated_s"] == 20, summary
        assert summary["latency_clock"] == "simulated", summary
        runs.run(file, scratch / "other", "--seed", "2")
        assert runs.fingerprint(scratch / "other") != prints[0]
        replay(scratch)
        faster_than_it_can(scratch)
    print("five runs of 20 s are the same to the bit; real-time factor",
          round(summary["real_time_factor"]))


def replay(scratch):
    file = scratch / "replay.yaml"
    file.write_text(f"""experiment: replay
duration: 20 s
sync: unpaced
nodes:
  scan: {{node: signal_playback, file: {scratch}/run0/scan.h5}}
  sectors: {{node: connect, weights: blocks}}
  encoder: {{node: rate_encoder, rate_min: 1 Hz, rate_max: 200 Hz}}
connections:
  - scan -> sectors [100] -> encoder [10]
""")
    runs.run(file, scratch / "replay")
    with h5py.File(scratch / "run0/encoder.h5") as first, \
            h5py.File(scratch / "replay/encoder.h5") as second:
        for name in ("timestamps_ns", "node_ids"):
            assert np.array_equal(first["spikes/out"][name], second["spikes/out"][name])


def faster_than_it_can(scratch):
    """It is always late and never waits: what it says that it computes is what it has done."""
    file = runs.new_experiment(scratch / "fast.yaml", real_time_factor="1000")
    summary, printed = runs.run(file, scratch / "fast")
    said = re.search(r"(\d+) of (\d+) ticks began more than a tick late\. Computing 1 s takes ([\d.e-]+) s here; "
                     r"a real_time_factor below (\S+) can be kept", printed)
    overruns, ticks, seconds, factor = (float(value) for value in said.groups())
    assert overruns == summary["overruns"] and ticks == summary["simulated_s"] * 1000 > 1000, (said[0], summary)
    for claimed in (1 / seconds, factor):
        assert 0.9 < claimed / summary["real_time_factor"] < 1.5, (said[0], summary)


if __name__ == "__main__":
    sys.exit(main())
