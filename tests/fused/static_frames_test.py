#!/usr/bin/python3
"""/tf_static of the robot's own process: who comes late gets it, of either ROS; and of a robot that is
stepped every run gets it once."""

import pathlib
import subprocess
import sys
import tempfile
import time

import h5py

import ros
import runs

EXPERIMENT = """experiment: frames
duration: 3 s
ros: {version}
sync: {sync}
nodes:
  fixed: {{node: ros_sensor, topic: /tf_static, message: tf2_msgs/TFMessage,
          fields: ["transforms[child_frame_id=laser].transform.translation.x",
                   "transforms[child_frame_id=laser].transform.translation.z"]}}
  moving: {{node: ros_sensor, topic: /tf, message: tf2_msgs/TFMessage,
           fields: ["transforms.transform.rotation.w"]}}
  a: {{node: low_pass}}
  b: {{node: low_pass}}
  c: {{node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, sensor_timeout: 0 s,
       max_age: 0 s, fields: {{linear.x: 0}}}}
connections:
  - fixed -> a [2]
  - moving -> b [1] -> c [1]
"""


def see(scratch, version, sync):
    file = scratch / "frames.yaml"
    file.write_text(EXPERIMENT.format(version=version, sync=sync))
    folder = scratch / f"run-{time.monotonic_ns()}"
    summary, printed = runs.run(file, folder)
    counters = summary["processes"]["experiment"]["counters"]
    assert counters["fixed.messages"] == 1 and counters["moving.messages"] > 50, counters
    assert "/tf_static" not in printed, printed
    with h5py.File(folder / "fixed.h5") as recorded:
        values = recorded["signals/out/values"][:]
    assert values[-1].tolist() == [0.10, 0.12], values


def late_rospy():
    """What a node of ROS 1's own gets that comes late."""
    code = ("import rospy, tf2_msgs.msg as m; rospy.init_node('late', anonymous=True); "
            "print([t.child_frame_id for t in "
            "rospy.wait_for_message('/tf_static', m.TFMessage, 30).transforms])")
    said = subprocess.run(["/usr/bin/python3", "-c", code], capture_output=True, text=True,
                          check=True).stdout
    assert said == "['laser', 'camera_optical']\n", said


def main():
    robot = runs.programs() / "spikeloop-robot"
    for version in "12":
        with tempfile.TemporaryDirectory() as scratch, ros.place(version, pathlib.Path(scratch)):
            scratch = pathlib.Path(scratch)
            with ros.program(robot, "--ros", version, "--out", scratch / "robot"):
                ros.until((scratch / "robot/trajectory.csv").exists, "a robot")
                if version == "1":
                    late_rospy()
                see(scratch, version, "realtime")
            with ros.program(robot, "--ros", version, "--step"):
                for _ in range(2):
                    see(scratch, version, "lockstep")
        print(f"/tf_static over ROS {version}")


if __name__ == "__main__":
    sys.exit(main())
