#!/usr/bin/python3
"""The recorded sensor messages drive the brain again and give the same spikes: of a run in lockstep,
of one in real time over ROS 1, of one that was stopped. Changed weights are told of, and other
spikes."""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

import h5py

import bags
import runs
from mcap_file import McapFile

BOTH = """experiment: both
duration: 5 s
sync: {sync}
robot: {{simulator: mujoco}}
ros: {ros}
nodes:
  scan: {{node: ros_sensor, topic: /scan, message: LaserScan}}
  place: {{node: ros_sensor, topic: /odom, message: Odometry, fields: [pose.pose.position.x, pose.pose.position.y]}}
  speed: {{node: ros_sensor, topic: /odom, message: Odometry, fields: [twist.twist.linear.x]}}
  sectors: {{node: connect, weights: blocks}}
  eye: {{node: rate_encoder, rate_max: 200 Hz}}
  grid: {{node: poisson_encoder, rate_max: 300 Hz}}
  pace: {{node: rate_encoder, rate_max: 500 Hz}}
  decoder: {{node: linear_readout, tau: 30 ms, weights: weights.json}}
  wheels: {{node: ros_command, topic: /cmd_vel, message: Twist, fields: {{linear.x: 0, angular.z: 1}},
           limits: {{linear.x: [-2, 2], angular.z: [-9, 9]}}}}
connections:
  - scan -> sectors [100] -> eye [10] -> decoder [10] -> wheels [2]
  - place -> grid [2, delay 3 ms]
  - speed -> pace [1]
"""


def both(scratch, sync="lockstep", ros="none"):
    (scratch / "weights.json").write_text(json.dumps([[0.002] * 10, [0.001, -0.001] * 5]))
    file = scratch / "both.yaml"
    file.write_text(BOTH.format(sync=sync, ros=ros))
    return file


def same(first, second):
    first, second = map(runs.recordings.spikes_of_run, (first, second))
    assert runs.recordings.same(first, second), (first, second)
    counts = [len(times) for times, _ in first.values()]
    assert all(counts), counts
    return sum(counts)


def replayed(folder, *more, **options):
    """How many spikes the program says are the same; and a comparison of our own."""
    number = 1
    while (folder.parent / f"{folder.name}-replay-{number}").exists():
        number += 1
    printed = bags.spikeloop("replay", folder, *more, **options)
    again = folder.parent / f"{folder.name}-replay-{number}"
    count = same(folder, again)
    assert f"spikeloop: {count:,} spikes: the same in both runs" in printed, printed
    assert "warning" not in printed, printed
    return count, again


def in_lockstep(scratch):
    file = both(scratch)
    runs.run(file, scratch / "step", "--seed", "7", "--duration", "4")
    count, again = replayed(scratch / "step")
    summary = json.loads((again / "summary.json").read_text())
    assert summary["simulated_s"] == 4 and summary["seed"] == 7, summary
    # From elsewhere, and of a replay itself.
    (scratch / "elsewhere").mkdir()
    replayed(again, cwd=scratch / "elsewhere")
    replayed(scratch / "step", "-q")
    print(count, "spikes in lockstep")


def hesitate(folder, seconds=0.13):
    """Stops the robot's process for a moment, two seconds after it has come: its scans shift."""
    pid = ""
    for _ in range(600):
        pid = subprocess.run(["pgrep", "-f", f"spikeloop-robot.* --out {folder}"],
                             capture_output=True, text=True).stdout.split()
        if pid:
            break
        time.sleep(0.1)
    time.sleep(2)
    os.kill(int(pid[0]), signal.SIGSTOP)
    time.sleep(seconds)
    os.kill(int(pid[0]), signal.SIGCONT)


def over_ros(scratch):
    """The robot is a process of its own, and wall time decides when a scan comes."""
    folder = scratch / "ros"
    threading.Thread(target=hesitate, args=[folder], daemon=True).start()
    summary, _ = runs.run(both(scratch, "realtime", "1"), folder)
    assert summary["layout"] == "fused" and summary["scans"] > 60, summary
    assert summary["messages_dropped"] == 0, summary
    messages = McapFile(folder / "messages.mcap")
    stamps = [time for time, _ in messages.raw("/scan")]
    assert len(messages.raw("/cmd_vel")) > 50
    assert messages.nodes_of("/odom") == {"place", "speed"}, messages.channels
    with h5py.File(folder / "scan.h5") as file:
        # The ticks at which values changed, which have their ends there: a row for several messages, and none
        # while the vehicle stands.
        ticks = (file["signals/out/times_ns"][:] - 1_000_000).tolist()
        assert len(ticks) > 30 and set(ticks) <= set(stamps), (ticks, stamps)
    assert len({stamp % 50_000_000 for stamp in stamps}) > 1, "wall time decided nothing"
    count, _ = replayed(folder)
    print(count, "spikes in real time over ROS 1")


def stopped(scratch):
    folder = scratch / "stopped"
    file = both(scratch, "realtime")
    process = runs.started(file, folder)
    runs.wait_for_row(folder, process, lambda row: row["t_s"] > 0.5)
    runs.interrupt(process)
    simulated = json.loads((folder / "summary.json").read_text())["simulated_s"]
    assert 0.2 < simulated < 4.9, simulated
    _, again = replayed(folder)
    assert json.loads((again / "summary.json").read_text())["simulated_s"] == simulated


def changed_files(scratch):
    """The network that answers is not the one of the run."""
    (scratch / "net.yaml").write_text(
        "populations:\n  i: {model: input, size: 10}\n  r: {model: repeater, size: 10}\n"
        "connections:\n  - {from: i, to: r, rule: one_to_one, delay: 1 ms}\noutput: [r]\n")
    file = both(scratch)
    text = file.read_text().replace("nodes:\n", "nodes:\n  brain: {simulator: builtin, network: net.yaml}\n")
    file.write_text(text.replace("eye [10] -> decoder", "eye [10] -> brain [10] -> decoder"))
    runs.run(file, scratch / "changed")
    replayed(scratch / "changed")
    network = scratch / "net.yaml"
    network.write_text(network.read_text().replace("1 ms", "2 ms"))
    file.unlink()  # the run's own copies are used
    printed = bags.spikeloop("replay", scratch / "changed")
    runs.assert_says(printed, f"'{network}' has changed since the run: its copy in the run folder is used")
    shutil.copy(network, scratch / "changed/experiment-files/net.yaml")
    printed = bags.spikeloop("replay", scratch / "changed", "--out", scratch / "other", code=6)
    assert f"warning: '{network}' has changed since the run: spikes may differ" in printed, printed
    first = [runs.recordings.spikes(scratch / name, "brain") for name in ("changed", "other")]
    (mine, channel), (theirs, other) = [(times[0], ids[0]) for times, ids in first]
    assert theirs == mine + 1_000_000
    def at(time):
        return f"{time // 10**9}.{time % 10**9:09} s"
    expected = (f"spikeloop: the spikes of node 'brain' differ first: the run has one in channel "
                f"{channel} at {at(mine)}, the replay one in channel {other} at {at(theirs)}\n")
    assert expected in printed, (printed, expected)
    network.unlink()
    (scratch / "changed/experiment-files/net.yaml").unlink()
    printed = bags.spikeloop("replay", scratch / "changed", code=2)
    runs.assert_says(printed, f"'{network}' is gone since the run", "key 'network': ... net.yaml' ... [SL0108]")


def interrupted(scratch):
    """A replay that is stopped compares nothing."""
    file = both(scratch)
    runs.run(file, scratch / "long", "--duration", "120")
    process = runs.started(scratch / "long", scratch / "again", command="replay")
    assert "same" not in runs.interrupt(process)


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        in_lockstep(scratch)
        over_ros(scratch)
        stopped(scratch)
        changed_files(scratch)
        interrupted(scratch)
    print("replays give the same spikes")


if __name__ == "__main__":
    sys.exit(main())
