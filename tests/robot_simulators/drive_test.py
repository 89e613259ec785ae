#!/usr/bin/python3
"""The experiments for other simulators drive Spikeloop's own robot in their place, with either clock."""

import contextlib
import fcntl
import math
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import unittest

import yaml
from folders import PROGRAMS, SIMULATORS, SOURCE

sys.path += [str(SOURCE / "tests" / folder) for folder in ("fused", "support")]
import growing_file  # noqa: E402
import ros  # noqa: E402

DEADLINE_S = 120  # of what waits; nothing is timed by it


@contextlib.contextmanager
def domain():
    """A domain of ROS 2 on this machine alone, which no other test has (tests/ros2/domain.hpp)."""
    for number in range(1, 101):
        with open(f"{tempfile.gettempdir()}/spikeloop-test-ros-domain-{number}", "a", encoding="ascii") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield {"ROS_DOMAIN_ID": str(number), "ROS_LOCALHOST_ONLY": "1"}
            return
    raise RuntimeError("a hundred tests use a ROS domain each")


@contextlib.contextmanager
def surroundings(version, folder):
    """The variables with which programs meet over this ROS."""
    if version == 2:
        with domain() as place:
            yield {**os.environ, **place}
    else:
        with ros.master(folder):
            yield dict(os.environ)


@contextlib.contextmanager
def robot(experiment, folder, variables):
    """Where it leaves its path, in a world whose steps are as long as the simulator's."""
    steps_hz = 1000 / float(experiment["tick"].removesuffix(" ms"))
    command = [PROGRAMS / "spikeloop-robot", "--out", folder, f"--clock-rate={steps_hz:g}"]
    if experiment["ros"] == 2:
        command.append("--ros=2")
    process = subprocess.Popen(command, env=variables, stdout=subprocess.DEVNULL)
    try:
        ros.until((folder / "trajectory.csv").exists, "a robot")
        yield folder / "trajectory.csv"
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(DEADLINE_S)


class Drive(unittest.TestCase):
    def drive(self, file, sync):
        experiment = yaml.safe_load(file.read_text(encoding="utf-8"))
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch)
            with surroundings(experiment["ros"], folder) as variables:
                with robot(experiment, folder / "robot", variables) as trajectory:
                    done = subprocess.run(
                        [PROGRAMS / "spikeloop", "run", file, "--sync", sync, "--duration", "3s",
                         "--out", folder / "run"], env=variables, capture_output=True, text=True,
                        timeout=DEADLINE_S, check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            path = [(float(row["x_m"]), float(row["y_m"])) for row in growing_file.table(trajectory)]
        farthest_m = max(math.dist(place, path[0]) for place in path)
        self.assertGreater(farthest_m, 0.3)

    def test_every_experiment_with_either_clock(self):
        for file in sorted(SIMULATORS.glob("*/braitenberg*.yaml")):
            for sync in ("realtime", "sim_time"):
                with self.subTest(f"{file.parent.name}/{file.name}", sync=sync):
                    self.drive(file, sync)


if __name__ == "__main__":
    sys.exit(unittest.main())
