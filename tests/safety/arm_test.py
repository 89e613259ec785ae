#!/usr/bin/python3
"""A stop holds the arm where it is: at the end of a run, and if the guard stops it because its program was killed."""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

import loop
from robots import ros

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
import jobs  # noqa: E402

# The damping lets the elbow approach its goal, 1.5 rad, within seconds.
MODEL = """<mujoco>
  <option timestep="0.001" gravity="0 0 0"/>
  <worldbody>
    <body><joint name="elbow" type="hinge" axis="0 1 0" damping="20"/><geom size="0.1" pos="0.3 0 0" mass="0.5"/></body>
    <body pos="0 1 0"><joint name="wheel" type="hinge" axis="0 1 0"/><geom size="0.1" mass="0.5"/></body>
  </worldbody>
  <actuator><position joint="elbow" kp="20"/><velocity joint="wheel" kv="1"/></actuator>
</mujoco>
"""
EXPERIMENT = """experiment: arm
ros: 1
sync: realtime
tick: 5 ms
duration: 60 s
robot: {simulator: mujoco, model: arm.xml}
nodes:
  joints: {node: ros_sensor, topic: /joint_states, message: sensor_msgs/JointState, fields: ["position[name=elbow]"]}
  goal: {node: function, function: "1.5; 4"}
  arm:
    node: ros_command
    topic: /joint_commands
    message: sensor_msgs/JointState
    fields: {"position[name=elbow]": 0, "velocity[name=wheel]": 1}
connections:
  - joints -> goal [1] -> arm [2]
"""
GOAL = 1.5


class Arm:
    """What the arm is commanded, and where it is."""

    def __init__(self):
        import rospy
        from sensor_msgs.msg import JointState
        rospy.init_node("witness", disable_signals=True)
        self.commands, self.elbow = [], []
        self._topics = [rospy.Subscriber("/joint_commands", JointState, self._command),
                        rospy.Subscriber("/joint_states", JointState, self._state)]

    def _command(self, message):
        assert message.name == ["elbow", "wheel"], message
        assert message.position[1] != message.position[1], "the wheel has no position"
        assert message.velocity[0] != message.velocity[0], "the elbow has no velocity"
        self.commands.append((message.position[0], message.velocity[1]))

    def _state(self, message):
        self.elbow.append(message.position[message.name.index("elbow")])

    def is_half_way(self):
        return self.commands and self.elbow and self.elbow[-1] > GOAL / 4


def kill(launcher):
    os.kill(jobs.find(launcher.pid, "spikeloop-fused", None), signal.SIGKILL)


def interrupt(launcher):
    launcher.send_signal(signal.SIGINT)


def check_stop(arm, folder, stop, code):
    arm.commands.clear()
    arm.elbow.clear()
    launcher = subprocess.Popen([loop.PROGRAMS / "spikeloop", "run", "arm.yaml", "--out", folder / stop.__name__],
                                cwd=folder, start_new_session=True)
    try:
        ros.until(arm.is_half_way, "a movement", 90)
        before = arm.elbow[-1]
        assert set(arm.commands) == {(GOAL, 4)}, arm.commands
        stop(launcher)
        assert launcher.wait(30) == code, launcher.returncode
    finally:
        if launcher.poll() is None:
            os.killpg(launcher.pid, signal.SIGKILL)
            launcher.wait()
    time.sleep(0.5)
    held = {command for command in arm.commands if command != (GOAL, 4)}
    print(f"{stop.__name__}: at {before:.3f} rad, then commands {held}", flush=True)
    assert len(held) == 1, "a stop has one position"
    position, velocity = held.pop()
    assert velocity == 0
    assert before - 0.1 < position < GOAL / 2, (before, position)
    assert arm.elbow[-1] < GOAL / 2, arm.elbow[-1]


def main():
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        (folder / "arm.xml").write_text(MODEL)
        (folder / "arm.yaml").write_text(EXPERIMENT)
        with ros.place("1", folder):
            arm = Arm()
            check_stop(arm, folder, interrupt, 130)
            check_stop(arm, folder, kill, 137)


if __name__ == "__main__":
    main()
