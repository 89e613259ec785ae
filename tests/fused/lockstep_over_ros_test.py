#!/usr/bin/python3
"""Lockstep over ROS: the same to the bit as with the robot in the process, every time."""

import contextlib
import pathlib
import sys
import tempfile

import ros
import runs

RUNS = (("short", ["--duration", "1"]), ("long", ["--duration", "4", "--seed", "4"]))


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        near = runs.new_experiment(scratch / "near.yaml", sync="lockstep")
        for name, options in RUNS:
            runs.run(near, scratch / name, *options)
        expected = [runs.fingerprint(scratch / name) for name, _ in RUNS]
        for version in "12":
            with ros.domain() if version == "2" else contextlib.nullcontext():
                over_ros(scratch, version, expected)


def over_ros(scratch, version, expected):
    far = runs.new_experiment(scratch / "far.yaml", sync="lockstep", ros=version)
    for (name, options), wanted in zip(RUNS, expected):
        for i in range(2 if name == "short" else 1):
            folder = scratch / f"{name}{i}-ros{version}"
            summary, printed = runs.run(far, folder, *options)
            assert runs.fingerprint(folder) == wanted, f"{folder}: {summary}"
            check(summary, printed, float(options[1]))
    coarse(scratch, version)
    print(f"the same to the bit over ROS {version} and without; {summary['simulated_s']:.0f} s at "
          f"{summary['real_time_factor']:.1f} times real time, "
          f"{1000 * summary['real_time_factor']:.0f} ticks/s")


def check(summary, printed, duration_s):
    experiment = summary["processes"]["experiment"]
    assert "finished" in printed and experiment["summary"]["simulated_s"] == duration_s, summary
    assert experiment["counters"]["wheels.stops_ended"] == 1, experiment
    for reason in ("no_tick", "data_too_old", "continued"):
        assert experiment["counters"][f"wheels.stops_{reason}"] == 0, experiment
    # Every message of a tick arrived before the tick: a scan every 50 ms, from time 0 on.
    assert experiment["counters"]["scan.messages"] == duration_s * 20 + 1, experiment
    # The robot took them all, the zero at the end included or not.
    taken = summary["processes"]["robot"]["counters"]["commands"]
    assert taken - experiment["counters"]["wheels.commands"] in (0, 1), summary


def coarse(scratch, version):
    """A tick in which several scans become due."""
    prints = []
    for name, over in (("one", "none"), (f"two{version}", version)):
        file = runs.new_experiment(scratch / f"{name}.yaml", sync="lockstep", ros=over,
                                   tick="130 ms", duration="2.6 s")
        runs.run(file, scratch / name)
        prints.append(runs.fingerprint(scratch / name))
    assert prints[0] == prints[1]


if __name__ == "__main__":
    sys.exit(main())
