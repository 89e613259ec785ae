"""STOP of one viewer while others attack the server, as a robot over ROS 2 on Fast DDS sees it."""

import contextlib
import pathlib
import subprocess
import sys
import time

import viewing

sys.path.append(str(pathlib.Path(__file__).parents[1] / "safety"))
import attack  # noqa: E402
import robots  # noqa: E402

PATIENCE_S = 20
EXPERIMENT = """experiment: attacked
sync: realtime
ros: 2
duration: 10 h
nodes:
  scan: {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}
  encoder: {node: rate_encoder, rate_max: 200 Hz}
  decoder: {node: linear_readout, tau: 30 ms, weights: uniform}
  wheels:
    node: ros_command
    topic: /cmd_vel
    message: geometry_msgs/Twist
    fields: {linear.x: {channel: 0, offset: 0.5}}
    limits: {linear.x: [0.1, 0.8]}
    sensor_timeout: 60 s
    max_age: 60 s
connections:
  - scan -> encoder [10]
  - encoder -> decoder [10] -> wheels [1]
"""


@contextlib.contextmanager
def robot(folder):
    with robots.robot("2", viewing.programs(), folder) as made:
        made.scans(True)
        yield made


def times_to_zero(robot, folder, kind, count, trials):
    """ms from each STOP to the zero command; inf ends the trials: not within PATIENCE_S.
    @param kind of attack.py; None: no attack"""
    experiment = folder / "attacked.yaml"
    experiment.write_text(EXPERIMENT)
    robot.forget()
    with viewing.Run(folder / "run", experiment=experiment) as run:
        viewer = viewing.Viewer(run.socket_url(), "/spikeloop/view")
        with attack.Attack(kind, run.url, count) if kind else contextlib.nullcontext():
            times = [press(robot, viewer)]
            while len(times) < trials and times[-1] < float("inf"):
                times.append(press(robot, viewer))
            run.process.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                run.end()
    return times


def press(robot, viewer):
    """Waits until the robot is driven, presses STOP, and releases it: ms to the zero command."""
    robots.ros.until(robot.is_driven, "a command")
    begin = time.monotonic()
    viewer.set("run.stop", True)
    took = robot.time_to_zero_ms(begin, PATIENCE_S)
    viewer.set("run.stop", False)
    viewer.socket.settimeout(0.001)  # reads what has come, so that the viewer does not lag
    with contextlib.suppress(Exception):
        while viewer.read():
            pass
    viewer.socket.settimeout(30)
    return took
