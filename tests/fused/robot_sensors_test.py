#!/usr/bin/python3
"""All of the robot's sensors, the camera too: the same to the bit in the process and over ROS 1 and 2,
filmed or not; and what is said where there is no such sensor."""

import contextlib
import os
import pathlib
import sys
import tempfile

import ros
import runs

EXPERIMENT = """experiment: sensors
duration: 2 s
sync: lockstep
seed: 4
ros: {ros}
robot: {{simulator: mujoco, world: {world}, camera: {{width: 16, height: 12}}}}
nodes:
  light: {{node: ros_sensor, topic: /light, message: std_msgs/Float64MultiArray}}
  imu: {{node: ros_sensor, topic: /imu, message: sensor_msgs/Imu,
        fields: [angular_velocity.z, linear_acceleration.y]}}
  wheels: {{node: ros_sensor, topic: /joint_states, message: sensor_msgs/JointState, fields: [velocity]}}
  frames: {{node: ros_sensor, topic: /tf, message: tf2_msgs/TFMessage,
           fields: ["transforms[0].transform.translation.x"]}}
  fixed: {{node: ros_sensor, topic: /tf_static, message: tf2_msgs/TFMessage,
          fields: ["transforms[child_frame_id=laser].transform.translation.x"]}}
  eye: {{node: ros_sensor, topic: /camera/image_raw, message: sensor_msgs/Image, fields: [data]}}
  turn: {{node: function, function: "x0; x1"}}
  a: {{node: low_pass}}
  b: {{node: low_pass}}
  c: {{node: low_pass}}
  d: {{node: low_pass}}
  e: {{node: low_pass}}
  drive: {{node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist,
          fields: {{linear.x: {{channel: 0, offset: 0.3}}, angular.z: 1}}}}
connections:
  - light -> turn [2] -> drive [2]
  - imu -> a [2]
  - wheels -> b [4]
  - frames -> c [1]
  - eye -> d [576]
  - fixed -> e [1]
"""


def written(scratch, name, world="phototaxis", over="none"):
    path = scratch / name
    path.write_text(EXPERIMENT.format(ros=over, world=world))
    return path


def same_everywhere(scratch):
    near = written(scratch, "near.yaml")
    runs.run(near, scratch / "near")
    expected = runs.fingerprint(scratch / "near")
    film = ["--render", str(scratch / "end.png"), "--render-size", "64x48"]
    runs.run(near, scratch / "filmed", *film)
    assert runs.fingerprint(scratch / "filmed") == expected, "a film has changed the run"
    assert (scratch / "end.png").read_bytes().startswith(b"\x89PNG")
    for version in "12":
        far = written(scratch, f"far{version}.yaml", over=version)
        meeting = ros.domain() if version == "2" else contextlib.nullcontext()
        with meeting:
            runs.run(far, scratch / f"far{version}")
        assert runs.fingerprint(scratch / f"far{version}") == expected, f"ROS {version}"


def refused(scratch):
    runs.refused("key 'topic': the robot sends nothing on /light in this world, which has no lamps; write  "
                 "world: phototaxis  or  t_maze, or give yours sites lamp_* (docs/robot.md)",
                 "check", written(scratch, "dark.yaml", world="arena"))
    runs.refused("key 'topic': the robot sends nothing on /lane in this world, which has no lanes; write  "
                 "world: lane, or give yours boxes lane_* (docs/robot.md)",
                 "check", written(scratch, "no_lane.yaml"), "--set", "light.topic=/lane")
    without = {key: value for key, value in os.environ.items() if "DISPLAY" not in key}
    runs.refused("display", "run", written(scratch, "near.yaml"), "--view", "--out", scratch / "view",
                 code=3, env=without)
    own = scratch / "alone.yaml"
    own.write_text("""experiment: alone
duration: 1 s
sync: unpaced
nodes:
  drive: {node: poisson_encoder}
  back: {node: linear_readout}
connections:
  - {from: drive.out, to: back.in, width: 1}
  - {from: back.out, to: drive.in, width: 1, delay: 1 ticks}
""")
    runs.refused("--render shows a simulated robot, and this experiment has none; leave it out",
                 "run", own, "--render", "x.png", cwd=scratch)


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        refused(scratch)
        same_everywhere(scratch)
    print("light, inertia, wheels, frames and pictures: the same to the bit, in the process and over ROS")


if __name__ == "__main__":
    sys.exit(main())
