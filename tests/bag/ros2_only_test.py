#!/usr/bin/python3
"""What ROS 1 does not know is left out of a run's bag, which is one of ROS 1, and said at the run's begin;
everything else is in it."""

import pathlib
import subprocess
import sys
import tempfile

import rosbag

import ros
import runs

EXPERIMENT = """experiment: arm
duration: 1 s
ros: 2
nodes:
  arm: {node: ros_sensor, topic: /arm, message: my_robot/msg/Arm.msg, fields: ["angles[0:3]"]}
  drive: {node: function, function: x0 + x1 + x2}
  wheels: {node: ros_command, topic: /cmd_vel, message: Twist, fields: {linear.x: 0}}
connections:
  - arm -> drive [3] -> wheels [1]
"""


def main():
    spikeloop = str(runs.programs() / "spikeloop")
    with tempfile.TemporaryDirectory() as scratch, ros.domain():
        scratch = pathlib.Path(scratch)
        (scratch / "my_robot/msg").mkdir(parents=True)
        # Arrays and texts with a bound are ROS 2's alone.
        (scratch / "my_robot/msg/Arm.msg").write_text("string<=8 name\nfloat64[<=3] angles\n")
        (scratch / "arm.yaml").write_text(EXPERIMENT)
        _, said = runs.run(spikeloop, scratch / "arm.yaml", scratch / "run")
        assert "warning: topic '/arm' is left out of messages.bag, which is a bag of ROS 1: " in said, said
        with rosbag.Bag(scratch / "run/messages.bag") as bag:
            kept = {connection.topic for connection in bag._get_connections()}
        assert kept == {"/cmd_vel"}, kept
        again = subprocess.run([spikeloop, "replay", str(scratch / "run")], capture_output=True, text=True,
                               check=False, cwd=scratch)
        assert again.returncode == 2 and "is not part of ROS 1" in again.stderr, again
    print("what ROS 1 does not know is left out of the bag")


if __name__ == "__main__":
    sys.exit(main())
