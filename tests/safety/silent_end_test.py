#!/usr/bin/python3
"""A run that ends while a sensor is silent has failed, but all its programs come to their end; over ROS, in one
process and in a job. It asks for no time limit."""

import json
import os
import pathlib
import sys
import tempfile

import people_test
import robots
from people_test import run_that_drives

# Beside the nodes: what a script does behind its loop takes longer than programs have after a failure.
CLERK = """import pathlib, time
import spikeloop
with spikeloop.music(spikes_in={"in": None}) as host:
    spikes = sum(len(tick.spikes("in")[0]) for tick in host)
time.sleep(4)
pathlib.Path(__file__).with_name("clerk.txt").write_text(str(spikes))
"""
WITH_CLERK = people_test.EXPERIMENT.replace("  decoder:", "  clerk: {simulator: python, script: clerk.py}\n  decoder:") + (
    "  - encoder -> clerk.in [10]\n")


def without_a_sensor_at_the_end(person, version, layout, out):
    (out.parent / "clerk.py").write_text(CLERK)
    # A busy machine may take half of the time until the robot is driven.
    with run_that_drives(person, version, layout, out, "--duration", "8",
                         experiment=WITH_CLERK) as (process, printed):
        person.odometry(False)
        assert process.wait(60) == 3, printed.read_text()
    person.odometry(True)
    robots.runs.assert_says(printed.read_text(), "the robot was stopped when the run ended: ... '/odom' ... 400 ms")
    summary = json.loads((out / "summary.json").read_text())
    assert summary["exit_code"] == 3 and summary.get("stopped_s", 0) > 1, summary
    clerk = out.parent / "clerk.txt"
    assert int(clerk.read_text()) > 100, "the script has not come to its end"
    clerk.unlink()


def main():
    programs, version = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"]), sys.argv[1]
    with tempfile.TemporaryDirectory() as scratch, robots.robot(
            version, programs, pathlib.Path(scratch)) as person:
        person.scans(True)
        person.odometry(True)
        for layout in ("fused", "music"):
            without_a_sensor_at_the_end(person, version, layout, pathlib.Path(scratch) / layout)
    print(f"runs that end without a sensor fail, in one process and in a job, over ROS {version}")


if __name__ == "__main__":
    sys.exit(main())
