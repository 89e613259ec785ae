#!/usr/bin/python3
"""A reader that knows the format alone reads what a run keeps: topics, types, definitions, counts, and numbers
that are those of the recorded signals. A bag that the real rosbag module wrote drives an experiment."""

import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np
import rosbag
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

import bags
import runs
from mcap_file import McapFile

KEPT = """experiment: kept
duration: 20 s
sync: {sync}
robot: {{simulator: mujoco}}
nodes:
  scan: {{node: ros_sensor, topic: /scan, message: LaserScan}}
  odom: {{node: ros_sensor, topic: /odom, message: Odometry, fields: [pose.pose.position.x, twist.twist.linear.x]}}
  encoder: {{node: rate_encoder, rate_max: 200 Hz}}
  shape: {{node: function, function: "0.3 + 0.2 * sin(5*x0); x1 - 0.1"}}
  wheels: {{node: ros_command, topic: /cmd_vel, message: Twist, fields: {{linear.x: 0, angular.z: 1}}}}
connections:
  - scan -> encoder [100]
  - odom -> shape [2] -> wheels [2]
"""


TICK = 1_000_000


def rows(file, stream):
    with h5py.File(file) as recording:
        group = recording["signals"][stream]
        return group["times_ns"][:], group["values"][:]


def sensor_rows(file):
    """A row has the end of the tick that used a message, the message its begin."""
    times, values = rows(file, "out")
    return (times - TICK).tolist(), values


def kept_messages(scratch):
    file = scratch / "kept.yaml"
    file.write_text(KEPT.format(sync="lockstep"))
    summary, _ = runs.run(file, scratch / "kept")
    file = McapFile(scratch / "kept/messages.mcap")
    assert file.ended
    resolved = (scratch / "kept/resolved.json").read_bytes()
    assert file.attachments == {"resolved.json": ("application/json", resolved)}
    messages = {}
    for topic, kind in (("/scan", LaserScan), ("/odom", Odometry), ("/cmd_vel", Twist)):
        name, *encodings, text = file.type_of(topic)
        assert (name, *encodings) == (kind._type, "ros1", "ros1msg"), name
        assert definition(text) == definition(kind._full_text), text
        messages[topic] = file.of(topic)
    counters = summary["counters"]
    assert len(messages["/scan"]) == counters["scan.messages"] == 400, counters
    assert len(messages["/odom"]) == counters["odom.messages"] == 1000, counters
    assert len(messages["/cmd_vel"]) == counters["wheels.commands"] + counters["wheels.stops_ended"]
    assert sum(map(len, messages.values())) == summary["messages_recorded"]
    assert summary["messages_dropped"] == 0
    compare(messages, scratch / "kept")


def definition(text):
    """Without comments and blank lines, and with whole names."""
    lines = (" ".join(line.split("#")[0].split()) for line in text.splitlines())
    return ["std_msgs/Header header" if line == "Header header" else line for line in lines if line]


def compare(messages, folder):
    times, values = sensor_rows(folder / "scan.h5")
    assert [time for time, _ in messages["/scan"]] == times
    for (_, message), row in zip(messages["/scan"], values):
        near = np.isfinite(message.ranges)
        assert np.allclose(bags.signal_of(message)[near], row[near], rtol=0, atol=1e-12)
    times, values = sensor_rows(folder / "odom.h5")
    assert [time for time, _ in messages["/odom"]] == times
    for (_, message), row in zip(messages["/odom"], values):
        assert row.tolist() == [message.pose.pose.position.x, message.twist.twist.linear.x]
    times, values = rows(folder / "wheels.h5", "command")
    assert len(set(values[:, 0])) > 100
    for time, message in messages["/cmd_vel"][:-1]:  # the last one is the stop
        row = values[np.searchsorted(times, time, side="right") - 1]
        assert row.tolist() == [message.linear.x, message.angular.z], (time, row, message)
    time, last = messages["/cmd_vel"][-1]
    assert time == 20 * 10**9 and last.linear.x == 0 and last.angular.z == 0, last


def foreign_bag(scratch, **options):
    """Arrival times of the wall clock; the bag begins 0.1 s before the first scan."""
    begin = 1_700_000_000_123_456_789
    scans = bags.arena(60)
    times = [begin + 100_000_000 + 50_000_000 * i + (i % 3) * 1_234_567 for i in range(len(scans))]
    path = bags.write(scratch / "foreign.bag",
                      [(begin, scans[0])], topic="/camera", **options)
    with rosbag.Bag(str(path), "a") as bag:
        for time, message in zip(times, scans):
            bag.write("/scan", message, bags.genpy.Time(time // 10**9, time % 10**9))
    for sync in ("lockstep", "unpaced", "realtime"):
        folder = scratch / f"foreign-{sync}"
        summary, _ = runs.run(bags.experiment(scratch / "foreign.yaml", path, sync), folder)
        # The first tick that is not before.
        expected = [-(-(time - begin) // TICK) * TICK for time in times]
        used, values = sensor_rows(folder / "scan.h5")
        assert used == expected, (sync, used, expected)
        for message, row in zip(scans, values):
            assert np.allclose(bags.signal_of(message), row, rtol=0, atol=1e-12)
        # Its last message is used for a tick.
        assert round(summary["simulated_s"] * 1e9) == expected[-1] + TICK, summary
    bags.spikeloop("replay", scratch / "foreign-realtime")


def full_disk(scratch):
    """Files may not grow beyond 150 kB; all others of this run are smaller."""
    file = scratch / "full.yaml"
    file.write_text(KEPT.format(sync="lockstep").replace("{node:", "{record: false, node:"))
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (150_000, 150_000))
    said = bags.spikeloop("run", file, "--out", scratch / "full", code=4, preexec_fn=limit,
                          restore_signals=False)  # so that SIGXFSZ stays ignored
    runs.assert_says(said, f"'{scratch}/full/messages.mcap': File too large",
                     "incomplete: messages.mcap")


def killed(scratch):
    """What the run had kept is there, but for its last half second."""
    file = scratch / "killed.yaml"
    file.write_text(KEPT.format(sync="realtime"))
    folder = scratch / "killed"
    process = subprocess.Popen([runs.SPIKELOOP, "run", str(file), "--out", str(folder)], stderr=subprocess.DEVNULL)
    messages = folder / "messages.mcap"
    while not messages.exists() or len(McapFile(messages).raw("/scan")) < 40:
        time.sleep(0.1)
    time.sleep(1)
    process.kill()
    process.wait(timeout=20)
    file = McapFile(messages)
    assert not file.ended and len(file.raw("/scan")) >= 45, len(file.raw("/scan"))
    again = bags.experiment(scratch / "again.yaml", messages, width=100)
    printed = bags.spikeloop("run", again, "--out", scratch / "after")
    assert f"warning: '{messages}' was not ended: only its first " in printed, printed
    times, _ = sensor_rows(scratch / "after/scan.h5")
    assert len(times) == len(file.raw("/scan")), times


def nothing_is_kept(scratch):
    file = scratch / "none.yaml"
    file.write_text(KEPT.format(sync="lockstep"))
    summary, _ = runs.run(file, scratch / "kept", "--no-record", "--duration", "1")
    assert "messages_recorded" not in summary, summary
    assert not (scratch / "kept/messages.mcap").exists()  # nor that of the run before


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        kept_messages(scratch)
        foreign_bag(scratch)
        foreign_bag(scratch, compression="bz2")
        foreign_bag(scratch, compression="lz4")
        full_disk(scratch)
        killed(scratch)
        nothing_is_kept(scratch)
    print("rosbag reads the messages of a run, and a run those of a bag of rosbag's")


if __name__ == "__main__":
    sys.exit(main())
