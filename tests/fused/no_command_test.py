#!/usr/bin/python3
"""A run without a command says so in its last line, and why. If its messages were all unusable, it has an exit code of its
own: over ROS, as a .music job, and with the same messages recorded."""

import json
import math
import pathlib
import sys
import tempfile
import threading

import ros

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
from calls import spikeloop  # noqa: E402

NOTHING_USABLE = 7
EXPERIMENT = """experiment: blind
tick: 5 ms
duration: 2 s
nodes:
  scan: {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}
  first: {node: function, function: x0}
  wheels: {node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, fields: {linear.x: 0}}
connections:
  - scan -> first [10] -> wheels [1]
"""
UNUSABLE = "spikeloop: no command was sent: none of the COUNT messages of 'scan' was usable (without_reading: COUNT)"
SILENT = "; no command was sent: no message of 'scan' arrived"


class BlindLaser:
    """Scans without a reading, 20 a second."""

    def __init__(self):
        import rospy
        from sensor_msgs.msg import LaserScan
        rospy.init_node("laser", disable_signals=True)
        self._scans = rospy.Publisher("/scan", LaserScan, queue_size=1)
        self._scan = LaserScan(angle_min=-1, angle_max=1, angle_increment=2 / 9, range_min=0.1, range_max=10,
                               ranges=10 * [math.nan])
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._send)

    def _send(self):
        while not self._end.wait(0.05):
            self._scans.publish(self._scan)

    def __enter__(self):
        self._thread.start()

    def __exit__(self, *_):
        self._end.set()
        self._thread.join()


def run(file, folder, code):
    """(last line, summary)"""
    _, printed = spikeloop("run", file, "--out", folder, code=code)
    last = [line for line in printed.splitlines() if line.startswith("spikeloop: ")][-1]
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["exit_code"] == code, summary
    assert "no command was sent" in summary["exit_reason"], summary
    return last, summary


def count_of(summary):
    """Messages of the sensor, whichever process has it."""
    counters = [summary.get("counters", {})] + [each["counters"] for each in summary.get("processes", {}).values()]
    return max(value for each in counters for name, value in each.items() if name.endswith(".messages"))


def check_unusable(file, folder):
    last, summary = run(file, folder, NOTHING_USABLE)
    count = count_of(summary)
    assert count > 10, summary
    assert last == UNUSABLE.replace("COUNT", str(count)), last
    print(f"{folder.name}: {last}", flush=True)


def main():
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        file = folder / "blind.yaml"
        file.write_text(f"ros: 1\n{EXPERIMENT}")
        with ros.master(folder):
            last, _ = run(file, folder / "silent", 0)
            assert last.startswith("spikeloop: finished: ") and last.endswith(SILENT), last
            spikeloop("export", file, "--out", folder / "job")
            with BlindLaser():
                check_unusable(file, folder / "experiment")
                check_unusable(folder / "job" / "experiment.music", folder / "music")
        recorded = folder / "recorded.yaml"
        recorded.write_text(f"robot: {{bag: experiment/messages.mcap}}\nsync: lockstep\n{EXPERIMENT}")
        check_unusable(recorded, folder / "recorded")


if __name__ == "__main__":
    main()
