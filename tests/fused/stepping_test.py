#!/usr/bin/python3
"""The robot and the experiment of docs/stepping.md, as they stand there: against a recurrence by hand,
twice the same; and robots that do not keep to the protocol."""

import json
import os
import pathlib
import re
import signal
import sys
import tempfile
import xmlrpc.client

import h5py
import numpy as np

import ros
import runs
import jobs  # from tests/support, which runs.py adds to the path
from growing_file import complete_text

PAGE = pathlib.Path(__file__).parents[2] / "docs/stepping.md"
BLOCKS = re.findall("```(?:python|cpp|yaml)\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.S)
IN_ROSPY, IN_RCLPY, IN_RCLCPP, EXPERIMENT = BLOCKS


def cart(scratch, *changes, text=IN_ROSPY):
    """The page's robot, with some of its text changed."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    (scratch / "cart.py").write_text(text)
    return ros.program("/usr/bin/python3", scratch / "cart.py")


def by_hand(steps, tick_ns=1_000_000):
    """Positions of the cart at the ticks: its speed is the command before, minus its position then."""
    x, v, wanted = 1.0, 0.0, []
    for _ in range(steps):
        wanted.append(x)
        x, v = x + v * tick_ns * 1e-9, -x
    return np.array(wanted)


def follows_the_recurrence(file, folder, *options):
    """One run of 500 ticks. @return its summary"""
    summary, _ = runs.run(file, folder, "--duration", "0.5", *options)
    with h5py.File(folder / "where.h5") as recording:
        assert np.array_equal(recording["signals/out/times_ns"][()], 1_000_000 * np.arange(1, 501))
        where = recording["signals/out/values"][:, 0]
    assert np.array_equal(where, by_hand(500)), np.abs(where - by_hand(500)).max()
    return summary


def lost_answer(file, scratch):
    """The experiment asks again; also a robot that was only slow, which then answers more than once."""
    for name, change in (
            ("lost", ("def answer():\n", "def answer():\n    if cart.setdefault('deaf', True):\n"
                      "        cart['deaf'] = False\n        return\n")),
            ("slow", ("        commands.clear()\n", "        commands.clear()\n        time.sleep(2.5)\n"))):
        with cart(scratch, change):
            follows_the_recurrence(file, scratch / name)


def registered():
    """Whether the master knows all topics of a cart."""
    publishers, subscribers, _ = xmlrpc.client.ServerProxy(os.environ["ROS_MASTER_URI"]).getSystemState("/test")[2]
    known = {topic for topic, _ in publishers} & {"/spikeloop/stepped", "/where"}
    return len(known | {topic for topic, _ in subscribers} & {"/spikeloop/step", "/go"}) == 4


def wrong_robots(file, scratch):
    answer = '"time_ns": cart["time_ns"]'
    for change, text in (
            ((answer, '"time_ns": cart["time_ns"] + 1'),
             "the robot stands at 1 ns instead of 0 ns; it has to advance exactly to to_ns"),
            (('"/where": cart', '"/there": cart'),
             "the robot's answer does not count the messages on /where"),
            (('cart["published"] += 1', "sensor.publish(data=[2.0])\n    cart['published'] += 1; "
              "time.sleep(0.2)"), "2 messages arrived on /where, but the robot published 1"),
            (("{" + answer, '{"error": "the battery is empty", ' + answer),
             "the robot cannot begin: the battery is empty"),
            (("json.dumps({", "str({"), "topic /spikeloop/stepped has brought "),
            (('cart["published"] += 1', 'cart["published"] += 2'),
             "1 of 2 messages on /where of 0 s have not come within 3 s"),
            (("Float64MultiArray, queue_size", "String, queue_size"),
             "topic '/where' carries std_msgs/String, not std_msgs/Float64MultiArray")):
        changes = [change]
        if "String, queue_size" in change[1]:
            changes.append(("data=[cart[\"x\"]]", "data='x'"))
        with cart(scratch, *changes):
            if "3 s" in text:
                ros.until(registered, "a robot")
            _, printed = runs.run(file, scratch / "wrong", *(("--stall-timeout", "3") if "3 s" in text else ()),
                                  code=3)
        runs.assert_says(printed, text)


def no_robot(file, scratch):
    _, printed = runs.run(file, scratch / "none", "--stall-timeout", "4", code=3)
    runs.assert_says(printed, "waits for a subscriber of /spikeloop/step, a publisher of /spikeloop/stepped, a "
                     "publisher of /where, a subscriber of /go; see docs/stepping.md",
                     "no robot has come that can be stepped: for 4 s there has not been a subscriber",
                     "start spikeloop-robot --step, or a robot that speaks the protocol")


def talkative_cart(scratch):
    """One that writes down what it is told."""
    parse, take = "request = json.loads(message.data)", "commands.append, "
    return cart(scratch, (parse, f"{parse}\n    print(message.data, file=requests, flush=True)"),
                (take, "lambda message: (print(message.data[0], file=taken, flush=True), "
                 "commands.append(message)), "),
                ("commands, ", f"requests, taken = open('{scratch}/requests', 'w'), "
                 f"open('{scratch}/speeds', 'w')\ncommands, "))


def ctrl_c(file, scratch):
    """While the experiment waits for the robot, and while it runs; the last command is a zero."""
    runs.interrupt(runs.started(file, scratch / "waiting"))
    with talkative_cart(scratch):
        process = runs.started(file, scratch / "running", "--duration", "1000")
        ros.until(lambda: ticks(scratch) > 100, "a tick")
        runs.interrupt(process)
        ros.until(lambda: complete_text(scratch / "requests").splitlines()[-1:] == ['{"end":true}'], "an end")
        ros.until(lambda: speeds(scratch)[-1] == 0, "a zero command")
    assert json.loads((scratch / "requests").read_text().splitlines()[-1]) == {"end": True}
    assert speeds(scratch)[-1] == 0


def speeds(scratch):
    """The commands that the cart received."""
    return [float(line) for line in complete_text(scratch / "speeds").splitlines()]


def ticks(scratch):
    return len(complete_text(scratch / "requests").splitlines())


def stopped_robot(file, scratch):
    (scratch / "requests").unlink()
    with talkative_cart(scratch) as robot:
        ros.until(registered, "a robot")
        process = runs.started(file, scratch / "stopped", "--duration", "1000", "--stall-timeout", "3")
        ros.until(lambda: ticks(scratch) > 100, "a tick")
        robot.send_signal(signal.SIGSTOP)
        printed = runs.ended(process, 3)
    # It may have answered, and not have sent the messages of that step.
    assert ("the robot has not answered on /spikeloop/stepped within 3 s" in printed
            or "messages on /where" in printed and "have not come within 3 s" in printed), printed


def killed_brain(file, scratch):
    """Nobody is left to say so: the guard stops the robot."""
    (scratch / "requests").unlink()
    with talkative_cart(scratch):
        process = runs.started(file, scratch / "killed", "--duration", "1000")
        ros.until(lambda: ticks(scratch) > 100, "a tick")
        assert speeds(scratch)[-1] != 0
        os.kill(jobs.find(process.pid, "spikeloop-fused"), signal.SIGKILL)
        runs.ended(process, 137, "9 (Killed)")
        ros.until(lambda: speeds(scratch)[-1] == 0, "a zero command")


def killed_robot(scratch):
    file = runs.new_experiment(scratch / "explorer.yaml", sync="lockstep", ros="1", duration="1000 s")
    process = runs.started(file, scratch / "alone")
    trajectory = scratch / "alone/trajectory.csv"
    ros.until(lambda: trajectory.exists() and trajectory.stat().st_size > 2000, "a path")
    os.kill(jobs.find(process.pid, "spikeloop-robot"), signal.SIGKILL)
    runs.ended(process, 137, "robot: ... 9 (Killed)")


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        file = scratch / "cart.yaml"
        file.write_text(EXPERIMENT)
        with ros.master(scratch):
            no_robot(file, scratch)
            with cart(scratch):
                for name in ("first", "second"):
                    summary = follows_the_recurrence(file, scratch / name)
            lost_answer(file, scratch)
            wrong_robots(file, scratch)
            ctrl_c(file, scratch)
            stopped_robot(file, scratch)
            killed_brain(file, scratch)
            killed_robot(scratch)
    print("the robot of the page keeps to its recurrence to the bit, at "
          f"{1000 * summary['real_time_factor']:.0f} ticks/s")


if __name__ == "__main__":
    sys.exit(main())
