#!/usr/bin/python3
"""A model with two robots that Spikeloop does not know: by the names of the file, with a sensor, a mesh and a
camera. The same to the bit in the process and over ROS 1 and 2; a run folder repeats it after the model has gone;
in real time over ROS 2 the robot follows; names that are not there are errors."""

import contextlib
import json
import pathlib
import shutil
import sys
import tempfile

import ros
import runs

MODEL = """<mujoco model="pair">
  <compiler meshdir="shapes"/>
  <option timestep="0.001" gravity="0 0 0"/>
  <asset><mesh name="wedge" file="wedge.obj"/></asset>
  <worldbody>
    <light pos="0 0 3"/>
    <camera name="eye" pos="0 -1.5 0.3" xyaxes="1 0 0 0 0.2 1"/>
    <body name="left" pos="-0.4 0 0">
      <joint name="left_hinge" type="hinge" axis="0 1 0" damping="0.05"/>
      <geom type="mesh" mesh="wedge" mass="1" rgba="0.9 0.3 0.2 1"/>
    </body>
    <body name="right" pos="0.4 0 0">
      <joint name="right_hinge" type="hinge" axis="0 1 0" damping="0.05"/>
      <geom type="box" size="0.2 0.05 0.1" mass="1" rgba="0.2 0.4 0.9 1"/>
    </body>
  </worldbody>
  <actuator>
    <motor name="left_motor" joint="left_hinge"/>
    <position name="right_servo" joint="right_hinge" kp="2"/>
  </actuator>
  <sensor><gyro name="spin" site="s"/></sensor>
</mujoco>
""".replace('<geom type="box"', '<site name="s"/><geom type="box"')
WEDGE = "v -.2 -.1 0\nv .2 -.1 0\nv 0 .1 0\nv 0 0 .3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
EXPERIMENT = """experiment: pair
duration: 2 s
sync: {sync}
ros: {ros}
robot: {{simulator: mujoco, model: pair.xml, rate: 200 Hz, camera: {{name: eye, width: 16, height: 12}}}}
nodes:
  left:
    node: ros_sensor
    topic: /joint_states
    message: sensor_msgs/JointState
    fields: ["position[name=left_hinge]", "position[name=right_hinge]"]
  spin: {{node: ros_sensor, topic: /sensors/spin, message: std_msgs/Float64MultiArray}}
  eye: {{node: ros_sensor, topic: /camera/image_raw, message: sensor_msgs/Image, image: {{resize: [4, 3]}}}}
  seen: {{node: low_pass}}
  drive: {{node: function, function: "0.2 - x0; 0.5 + 0 * x1"}}
  motors:
    node: ros_command
    topic: /joint_commands
    message: sensor_msgs/JointState
    fields: {{"effort[name=left_motor]": 0, "position[name=right_servo]": 1}}
connections:
  - left -> drive [2] -> motors [2]
  - eye -> seen [12]
"""


def written(scratch, name, over="none", sync="lockstep", text=EXPERIMENT):
    path = scratch / name
    path.write_text(text.format(ros=over, sync=sync))
    return path


def same_everywhere(scratch):
    runs.run(written(scratch, "near.yaml"), scratch / "near")
    expected = runs.fingerprint(scratch / "near")
    last = runs.last_values(scratch / "near" / "left.h5")
    # Torque 0.2 - angle against a damper: the angle becomes 0.2. The servo holds 0.5.
    assert abs(last[1] - 0.5) < 0.05, last
    for version in "12":
        far = written(scratch, f"far{version}.yaml", over=version)
        with ros.domain() if version == "2" else contextlib.nullcontext():
            runs.run(far, scratch / f"far{version}")
        assert runs.fingerprint(scratch / f"far{version}") == expected, f"ROS {version}"


def in_real_time(scratch):
    """With a process of its own the sensor without a connection would have MUSIC wait for ever."""
    path = written(scratch, "real.yaml", over="2", sync="realtime")
    for layout in ("fused", "separate"):
        with ros.domain():
            summary, _ = runs.run(path, scratch / layout, "--layout", layout)
        assert summary["processes"]["robot"]["counters"]["commands"] > 20, summary
        assert len(runs.last_values(scratch / layout / "spin.h5")) == 3
    assert abs(runs.last_values(scratch / "fused" / "left.h5")[1] - 0.5) < 0.05


def repeated_without_its_files(scratch):
    moved = scratch / "moved"
    shutil.copytree(scratch / "near", moved)
    for name in ("pair.xml", "near.yaml"):
        (scratch / name).unlink()
    shutil.rmtree(scratch / "shapes")
    runs.spikeloop("replay", moved)
    runs.run(moved, scratch / "again")
    assert runs.fingerprint(scratch / "again") == runs.fingerprint(moved)
    resolved = json.loads((scratch / "again" / "resolved.json").read_text())
    assert resolved["robot"]["model"].endswith("pair.xml") and resolved["robot"]["camera"]["name"] == "eye"


def names_are_checked(scratch):
    for wrong, by, error in (
            ("left_hinge", "left_hing", "field path 'position[name=left_hing]': the robot has no joint "
             "'left_hing'; did you mean 'left_hinge'?"),
            ("position[name=left_hinge]", "position[2]", "field path 'position[2]': the robot has 2 joints, "
             "counted from 0"),
            ("/sensors/spin", "/sensors/spim", "/sensors/spim ... '/sensors/spin'? ... [SL0507]"),
            ("effort[name=left", "position[name=left", "'position[name=left_motor]' ... /joint_commands ... [SL0504]"),
            ("name: eye", "name: eyes", "has no camera 'eyes'")):
        runs.refused(error, "check", written(scratch, "wrong.yaml", text=EXPERIMENT.replace(wrong, by)))
    said, _ = runs.spikeloop("describe", scratch / "pair.xml")
    for word in ("/sensors/spin", "3 values", "left_hinge, right_hinge",
                 "effort[name=left_motor], position[name=right_servo]", "Cameras: eye"):
        assert word in said, said


def main():
    with tempfile.TemporaryDirectory() as folder:
        scratch = pathlib.Path(folder)
        (scratch / "shapes").mkdir()
        (scratch / "shapes/wedge.obj").write_text(WEDGE)
        (scratch / "pair.xml").write_text(MODEL)
        names_are_checked(scratch)
        same_everywhere(scratch)
        in_real_time(scratch)
        repeated_without_its_files(scratch)


if __name__ == "__main__":
    sys.exit(main())
