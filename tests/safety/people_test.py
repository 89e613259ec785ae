#!/usr/bin/python3
"""People and sensors over ROS, in both layouts: the emergency stop is obeyed and released, commands by hand
leave within the limits, a second sensor that falls silent is named and comes back."""

import json
import math
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool

import time_to_zero
from time_to_zero import ros

EXPERIMENT = """experiment: people
ros: 1
nodes:
  scan: {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}
  odom: {node: ros_sensor, topic: /odom, message: nav_msgs/Odometry, fields: [pose.pose.position.x],
         timeout: 400 ms}
  encoder: {node: rate_encoder, rate_max: 200 Hz}
  brain:
    simulator: builtin
    network:
      populations:
        input: {model: input, size: 10}
        place: {model: signal_input, size: 1}
        relay: {model: repeater, size: 10}
      connections:
        - {from: input, to: relay, rule: one_to_one, delay: 1 ms}
      output: [relay]
  decoder: {node: linear_readout, tau: 30 ms, weights: uniform}
  wheels:
    node: ros_command
    topic: /cmd_vel
    message: geometry_msgs/Twist
    fields: {linear.x: {channel: 0, scale: 0.001, offset: 0.5}}
    limits: {linear.x: [0.1, 0.8]}
    override: {timeout: 300 ms}
connections:
  - scan -> encoder [10] -> brain.in [10]
  - odom -> brain.signal [1]
  - brain.out -> decoder [10] -> wheels [1]
"""


class Person(time_to_zero.Robot):
    def __init__(self):
        super().__init__()
        self.odometry = rospy.Publisher("/odom", Odometry, queue_size=1, tcp_nodelay=True)
        self.odom_on = True
        rospy.Timer(rospy.Duration(0.02), self._send_odometry)

    def _send_odometry(self, _):
        if self.odom_on:
            self.odometry.publish(Odometry())

    def last(self):
        return self.heard[-1][1] if self.heard else None


def stop_and_release(person):
    begin = time.monotonic()
    person.stop.publish(Bool(True))
    assert person.time_to_zero_ms(begin) < time_to_zero.MARGIN_MS
    time.sleep(0.5)
    assert not person.drives_after(begin), "driven while the emergency stop is pressed"
    person.manual.publish(Twist())
    time.sleep(0.1)
    assert not person.drives_after(begin), "driven by hand while the emergency stop is pressed"
    person.stop.publish(Bool(False))
    ros.until(person.is_driven, "driving after the release", 10)


def drive_by_hand(person):
    message = Twist()
    message.linear.x = 0.3
    for _ in range(10):
        person.manual.publish(message)
        time.sleep(0.05)
    by_hand = {value for at, value in person.heard if at > time.monotonic() - 0.3}
    assert by_hand == {0.3}, by_hand
    message.linear.x = 7
    person.manual.publish(message)
    ros.until(lambda: person.last() == 0.8, "the upper limit", 1)
    message.linear.x = math.nan
    person.manual.publish(message)
    ros.until(lambda: person.last() == 0, "a stop, as there is no such speed", 1)
    ros.until(lambda: person.is_driven() and person.last() not in (0.3, 0.8), "the network", 10)


def lose_a_sensor(person, printed):
    begin = time.monotonic()
    person.odom_on = False
    assert person.time_to_zero_ms(begin) < 400 + 2 * time_to_zero.MARGIN_MS
    ros.until(lambda: "has come on topic '/odom' for 400 ms" in printed.read_text(), "the topic's name", 5)
    person.odom_on = True
    ros.until(person.is_driven, "driving when it is back", 10)


def with_people(spikeloop, person, layout, folder):
    (folder / "people.yaml").write_text(EXPERIMENT)
    printed = folder / f"{layout}.txt"
    person.heard.clear()
    with open(printed, "w", encoding="utf-8") as log:
        process = subprocess.Popen(
            [spikeloop, "run", str(folder / "people.yaml"), "--layout", layout, "--out",
             str(folder / layout)], stdout=log, stderr=log)
    try:
        ros.until(lambda: person.is_driven() or process.poll() is not None, "a command", 90)
        assert process.poll() is None, printed.read_text()
        stop_and_release(person)
        drive_by_hand(person)
        lose_a_sensor(person, printed)
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(30)
    text = printed.read_text()
    assert "the emergency stop, topic '/emergency_stop', says so" in text, text
    assert "the robot is driven by hand, on topic '/cmd_vel_manual'" in text, text
    assert "topic '/cmd_vel_manual': a command by hand that is not a finite number stops the robot" in text, text
    processes = json.loads((folder / layout / "summary.json").read_text())["processes"]
    counters = {name.removeprefix("wheels.").removeprefix("topic."): value
                for process in processes.values() for name, value in process["counters"].items()}
    assert counters["stops_emergency_stop"] == 1 and counters["overrides"] == 1, counters
    assert counters["stops_sensor_silent"] >= 1 and counters["stops_ended"] == 1, counters


def main():
    spikeloop = str(pathlib.Path(sys.argv[1]).resolve() / "spikeloop")
    with tempfile.TemporaryDirectory() as folder, ros.master(pathlib.Path(folder)):
        person = Person()
        person.sending.set()
        for layout in ("fused", "separate"):
            with_people(spikeloop, person, layout, pathlib.Path(folder))
    print("people stop and drive the robot in both layouts")


if __name__ == "__main__":
    sys.exit(main())
