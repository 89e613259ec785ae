#!/usr/bin/python3
"""Subscribers that receive no command, because their type or quality of service differs, cause one warning. It names
reason, node and line to write. Publishers of another type cause the same warning. A latched message is received."""

import os
import pathlib
import re
import sys
import tempfile

import ros
import runs

PEER = sys.argv[1]
EXPERIMENT = """experiment: wrong
duration: 4 s
ros: {version}
nodes:
  scan: {{node: ros_sensor, topic: /scan, {sensor}}}
  out: {{node: connect, weights: [[0], [0]]}}
  go: {{node: ros_command, topic: /cmd_vel, {command}}}
connections:
  - scan -> out [1] -> go [2]
"""
SCAN = "message: sensor_msgs/LaserScan, fields: 'ranges[0]'"
TWIST = "message: geometry_msgs/Twist, fields: {linear.x: 0, angular.z: 1}"
STAMPED = "message: geometry_msgs/TwistStamped, fields: {twist.linear.x: 0, twist.angular.z: 1}"
TYPE = re.compile(r"warning: (.*) subscribes to '/cmd_vel' as geometry_msgs/Twist and gets no command of type "
                  r"geometry_msgs/TwistStamped; write  message: geometry_msgs/Twist  \(in a \.music file  "
                  r"message_type=geometry_msgs/Twist\), and its fields without 'twist\.', or another topic")
MISFITS = {"latched": "durability transient local", "deadline": "a deadline of 100 ms",
           "liveliness": "liveliness by topic", "lease": "a liveliness lease of 1 s"}


def printed_by(scratch, version, *, sensor=SCAN, command=TWIST, code=0):
    file = scratch / "wrong.yaml"
    file.write_text(EXPERIMENT.format(version=version, sensor=sensor, command=command))
    _, printed = runs.run(file, scratch / "run", code=code)
    return printed


def check_types(scratch, version):
    """spikeloop-robot subscribes to Twist, and publishes LaserScan."""
    with ros.program(runs.programs() / "spikeloop-robot", "--ros", version, "--out", scratch / "robot"):
        ros.until((scratch / "robot/trajectory.csv").exists, "a robot")
        printed = printed_by(scratch, version, command=STAMPED)
        assert [match.group(1) for match in TYPE.finditer(printed)] == ["node /spikeloop_robot"], printed
        assert "no subscriber" not in printed, printed
        printed = printed_by(scratch, version, code=3, sensor="message: sensor_msgs/Range, fields: range")
        assert ("topic '/scan' carries sensor_msgs/LaserScan, not sensor_msgs/Range; node /spikeloop_robot publishes "
                "it; write  message: sensor_msgs/LaserScan  (in a") in printed, printed
        assert "no message" not in printed, printed
        assert printed.count("[SL0508]") == 2, printed  # the program, and the launcher as the last line
        assert "gets no command" not in printed_by(scratch, version)


def check_policies(scratch, number):
    for mode, request in MISFITS.items():
        with ros.program(PEER, number, mode):
            printed = printed_by(scratch, "2")
        assert printed.count("gets no command") == 1 and f"it requests {request}" in printed, printed
        assert "no subscriber" not in printed, printed


def check_latched(scratch, number):
    """A scan that was published before the run, by another program, and no other."""
    file = scratch / "latched.yaml"
    command = f"{TWIST}, sensor_timeout: 0 s, max_age: 0 s"  # no other scan follows
    file.write_text(EXPERIMENT.format(version="2", sensor=SCAN, command=command))
    with ros.program(PEER, number, "one-scan"):
        summary, printed = runs.run(file, scratch / "latched")
    counters = summary["processes"]["experiment"]["counters"]
    assert counters["scan.messages"] == 1 and counters["scan.lost"] == 0, counters
    assert "no message on topic '/scan' for 2 s" not in printed and "no message arrived" not in printed, printed
    assert runs.last_values(scratch / "latched/scan.h5") != [], printed


def main():
    for version in "12":
        with tempfile.TemporaryDirectory() as scratch, ros.place(version, pathlib.Path(scratch)) as number:
            os.environ["ROS_DISTRO"] = "humble"  # nodes report their names
            check_types(pathlib.Path(scratch), version)
            if version == "2":
                del os.environ["ROS_DISTRO"]
                check_policies(pathlib.Path(scratch), number)
                check_latched(pathlib.Path(scratch), number)
        print(f"over ROS {version}")


if __name__ == "__main__":
    sys.exit(main())
