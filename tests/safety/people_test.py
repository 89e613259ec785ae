#!/usr/bin/python3
"""People and sensors over ROS, in both layouts: the emergency stop is obeyed and released, commands by hand
leave within the limits, a second sensor that falls silent is named and comes back."""

import contextlib
import json
import math
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

import loop
import robots
from robots import ros

OK, WARN, ERROR = range(3)  # diagnostic_msgs/DiagnosticStatus

EXPERIMENT = """experiment: people
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


def await_diagnosis(person, level, text):
    """On /diagnostics, where monitors of ROS look."""
    def told():
        return person.diagnosis[0] == level and f"spikeloop: commands on /cmd_vel: {text}" in person.diagnosis[1]
    ros.until(told, f"a status of level {level}, {text!r}", 5)


def stop_and_release(person, printed):
    await_diagnosis(person, OK, "the robot is driven by the network (commands ")
    ros.until(person.may_press_stop, "a run that hears the emergency stop")
    begin = time.monotonic()
    person.press_stop(True)
    assert person.time_to_zero_ms(begin) < loop.MARGIN_MS
    time.sleep(0.5)
    pressed = begin + loop.MARGIN_MS / 1e3
    assert not person.drives_since(pressed), "driven while the emergency stop is pressed"
    await_diagnosis(person, ERROR, "the robot is stopped: emergency stop on topic '/emergency_stop'")
    assert "stops_emergency_stop 1, " in person.diagnosis[1], person.diagnosis
    ros.until(lambda: "emergency stop on topic '/emergency_stop'" in printed.read_text(),
              "the line about it, which may wait for a second", 5)
    person.drive_by_hand(0)
    time.sleep(0.1)
    assert not person.drives_since(pressed), "driven by hand while the emergency stop is pressed"
    person.press_stop(False)
    ros.until(person.is_driven, "driving after the release", 10)


def sent_by_hand(person, speed):
    """When it left; the next one may follow."""
    person.drive_by_hand(speed)
    at = time.monotonic()
    time.sleep(0.05)
    return at


def drive_by_hand(person, printed):
    def announced():
        person.drive_by_hand(0.3)
        said = "manual commands on topic '/cmd_vel_manual' drive the robot"
        return said in printed.read_text() and person.diagnosis[0] == WARN and said in person.diagnosis[1]

    ros.until(announced, "the line about it, which may wait for a second, and the diagnosis", 5)
    sent = [0, 1]
    while max(later - at for at, later in zip(sent, sent[1:])) > 0.2:  # on a busy machine it could be too late
        sent = [sent_by_hand(person, 0.3) for _ in range(12)]
    by_hand = {value for at, value in person.heard if at > sent[3]}
    assert by_hand == {0.3}, by_hand
    for speed, wanted in ((7, 0.8), (math.nan, 0)):  # the upper limit; a stop, as there is no such speed
        begin = time.monotonic()
        person.drive_by_hand(speed)
        ros.until(lambda begin=begin, wanted=wanted: wanted in [value for at, value in person.heard if at > begin],
                  f"a command of {wanted} after {speed}", 1)
    ros.until(lambda: person.is_driven() and person.last() not in (0.3, 0.8), "the network", 10)


def lose_a_sensor(person, printed):
    begin = time.monotonic()
    person.odometry(False)
    assert person.time_to_zero_ms(begin) < 400 + 2 * loop.MARGIN_MS
    ros.until(lambda: "with a reading on topic '/odom' for 400 ms" in printed.read_text(), "the topic's name", 5)
    person.odometry(True)
    ros.until(person.is_driven, "driving when it is back", 10)


@contextlib.contextmanager
def run_that_drives(person, version, layout, out, *options, experiment=EXPERIMENT):
    """Gives the process and the path of what it prints."""
    (out.parent / "people.yaml").write_text(experiment)
    printed = out.with_suffix(".txt")
    person.forget()
    with open(printed, "w", encoding="utf-8") as log:
        process = subprocess.Popen(
            [*loop.command(out.parent / "people.yaml", version, layout), "--out", out, *options],
            stdout=log, stderr=log)
    try:
        ros.until(lambda: person.is_driven() or process.poll() is not None, "a command", 90)
        assert process.poll() is None, printed.read_text()
        yield process, printed
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(30)


def with_people(person, version, layout, folder):
    with run_that_drives(person, version, layout, folder / layout) as (_, printed):
        stop_and_release(person, printed)
        drive_by_hand(person, printed)
        lose_a_sensor(person, printed)
    text = printed.read_text()
    assert "topic '/cmd_vel_manual': a manual command that is not a finite number stops the robot" in text, text
    processes = json.loads((folder / layout / "summary.json").read_text())["processes"]
    counters = {name.removeprefix("wheels.").removeprefix("topic."): value
                for process in processes.values() for name, value in process["counters"].items()}
    # A busy machine may hold up the one who drives by hand for longer than the 300 ms that a command holds.
    assert counters["stops_emergency_stop"] == 1 and 1 <= counters["overrides"] < 5, counters
    assert counters["stops_sensor_silent"] >= 1 and counters["stops_ended"] == 1, counters


def main():
    programs, version = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"]), sys.argv[1]
    with tempfile.TemporaryDirectory() as scratch, robots.robot(
            version, programs, pathlib.Path(scratch)) as person:
        person.scans(True)
        person.odometry(True)
        for layout in ("fused", "music"):
            with_people(person, version, layout, pathlib.Path(scratch))
    print(f"people stop and drive the robot, in one process and in a job, over ROS {version}")


if __name__ == "__main__":
    sys.exit(main())
