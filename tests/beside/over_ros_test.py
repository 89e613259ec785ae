#!/usr/bin/python3
"""A script steers a robot over either ROS: in real time, which a replay repeats; in lockstep, to the bit as
in the process; by /clock; and without waiting."""

import contextlib
import pathlib
import sys
import tempfile

import experiments
import ros

BRAIN = "simulator: python\nscript: echo.py"


def over_ros(scratch, name, version, **keys):
    file = experiments.explorer(scratch, BRAIN, ros=version, **keys)
    summary, printed = experiments.run(file, scratch / name)
    assert "robot-arg" not in printed, printed
    assert summary["layout"] == "fused" and summary["exit_reason"] == "finished", summary
    counters = summary["processes"]["experiment"]["counters"]
    assert counters["wheels.stops_ended"] == 1, counters
    assert summary["scans"] > 0 and summary["spikes"] > 100, summary
    return summary


def real_time(scratch, version):
    summary = over_ros(scratch, "real", version, sync="realtime", duration="3 s")
    assert summary["scans"] > 24 and summary["distance_m"] > 0.15, summary
    experiments.runs.spikeloop("replay", scratch / "real")


def inside(scratch):
    """The same as lockstep, without ROS. @return the run's folder"""
    file = experiments.explorer(scratch, BRAIN, sync="lockstep", duration="1 s")
    experiments.run(file, scratch / "inside")
    return scratch / "inside"


def lockstep(scratch, version, expected):
    over_ros(scratch, "stepped", version, sync="lockstep", duration="1 s")
    for node in ("encoder", "brain"):
        experiments.assert_same(experiments.spikes(expected, node), experiments.spikes(scratch / "stepped", node), node)
    paths = [(folder / "trajectory.csv").read_bytes() for folder in (expected, scratch / "stepped")]
    assert paths[0] == paths[1]


def every_sync(scratch, version, expected):
    real_time(scratch, version)
    lockstep(scratch, version, expected)
    over_ros(scratch, "clock", version, sync="sim_time", duration="1 s")
    over_ros(scratch, "unpaced", version, sync="unpaced", duration="10 s")
    print(f"a script steers over ROS {version} with every sync")


def main():
    with tempfile.TemporaryDirectory() as scratch:
        expected = inside(pathlib.Path(scratch))
        for version in "12":
            with tempfile.TemporaryDirectory() as folder, (
                    ros.domain() if version == "2" else contextlib.nullcontext()):
                every_sync(pathlib.Path(folder), version, expected)


if __name__ == "__main__":
    sys.exit(main())
