#!/usr/bin/python3
"""Messages of ROS 2 are kept as they are, also of types that ROS 1 cannot have, and a replay repeats the run."""

import pathlib
import struct
import sys
import tempfile

import bags
import ros
import runs
from mcap_file import McapFile

EXPERIMENT = """experiment: arm
duration: 2 s
ros: 2
robot: {simulator: mujoco}
nodes:
  scan: {node: ros_sensor, topic: /scan, message: LaserScan}
  encoder: {node: rate_encoder, rate_max: 200 Hz}
  drive: {node: linear_readout, weights: blocks}
  arm: {node: ros_command, topic: /arm, message: my_robot/msg/Arm.msg, fields: {angle: 0}}
connections:
  - scan -> encoder [100] -> drive -> arm [1]
"""
# A text with a bound is ROS 2's alone.
ARM = "string<=8 name\nfloat64 angle\n"


def main():
    with tempfile.TemporaryDirectory() as scratch, ros.domain():
        scratch = pathlib.Path(scratch)
        (scratch / "my_robot/msg").mkdir(parents=True)
        (scratch / "my_robot/msg/Arm.msg").write_text(ARM)
        (scratch / "arm.yaml").write_text(EXPERIMENT)
        runs.run(scratch / "arm.yaml", scratch / "run")
        file = McapFile(scratch / "run/messages.mcap")
        assert file.type_of("/scan")[:3] == ("sensor_msgs/msg/LaserScan", "cdr", "ros2msg")
        assert file.type_of("/arm") == ("my_robot/msg/Arm", "cdr", "ros2msg", ARM)
        scans = file.raw("/scan")
        # CDR: 4 bytes say the byte order; the header begins with its stamp.
        assert all(data[:4] == b"\0\1\0\0" for _, data in scans), scans[0]
        stamps = [seconds * 20 + ns // 50_000_000 for seconds, ns in
                  (struct.unpack_from("<iI", data, 4) for _, data in scans)]
        assert len(scans) > 20 and stamps == list(range(stamps[0], stamps[0] + len(stamps))), stamps
        moved = [struct.unpack_from("<d", data, 12)[0] for _, data in file.raw("/arm")]
        assert len(set(moved)) > 10, moved
        bags.spikeloop("replay", scratch / "run")
        again = scratch / "again.yaml"
        again.write_text(EXPERIMENT.replace("ros: 2\n", "").replace("{simulator: mujoco}", "{bag: run/messages.mcap}"))
        runs.run(again, scratch / "again")
        assert McapFile(scratch / "again/messages.mcap").raw("/scan") == scans
    print(f"{len(scans)} scans and {len(moved)} commands of ROS 2, kept and repeated")


if __name__ == "__main__":
    sys.exit(main())
