#!/usr/bin/python3
"""Nodes of ROS 1 with another type, or another version of a type: an error or a warning names node and type."""

import contextlib
import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "fused"))
import ros  # noqa: E402
import runs  # noqa: E402

EXPERIMENT = """experiment: types
duration: DURATION s
ros: 1
nodes:
  value: {node: ros_sensor, topic: /v, message: std_msgs/Float64, fields: [data]}
  same: {node: clip, min: -10, max: 10}
  go: {node: ros_command, topic: /go, message: std_msgs/Float64MultiArray, emergency_stop: {topic: /stop}}
connections:
  - value -> same [1] -> go [1]
"""
NODE = """
import sys, time, rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Bool, Float64, Float64MultiArray, Int64

class Version(Float64):
    _md5sum = "00112233445566778899aabbccddeeff"

name, delay_s = sys.argv[1], float(sys.argv[2])
rospy.init_node(name, disable_signals=True, disable_rosout=True)
time.sleep(delay_s)
if name in ("base", "robot"):
    rospy.Subscriber("/go", {"base": Twist, "robot": Float64MultiArray}[name], lambda message: None)
    time.sleep(60)
topic, kind, value = {"right": ("/v", Float64, 1.0), "other": ("/v", Int64, 4617315517961601024),
                      "version": ("/v", Version, 5.0), "button": ("/stop", Bool, True),
                      "no_button": ("/stop", Int64, 0)}[name]
publisher = rospy.Publisher(topic, kind, queue_size=10)
print("publishes", flush=True)
while True:
    publisher.publish(value)
    time.sleep(0.02)
"""
OTHER = ("topic '/v' carries std_msgs/Int64, not std_msgs/Float64; node /other publishes it; write  message: "
         "std_msgs/Int64")
VERSION = ("topic '/v' carries another version of std_msgs/Float64 (md5 sum 00112233445566778899aabbccddeeff, Spikeloop's is "
           "fdb28210bfa9d7c91146260178d9a584) ... node /version publishes it")


@contextlib.contextmanager
def nodes(*names, delay_s=0.0):
    """Nodes that send or receive after a delay; without a delay, publishers are connected before the block begins."""
    with contextlib.ExitStack() as stack:
        for name in names:
            node = subprocess.Popen(["/usr/bin/python3", "-c", NODE, name, str(delay_s)], stdout=subprocess.PIPE,
                                    stderr=subprocess.DEVNULL)
            stack.callback(node.wait)
            stack.callback(node.kill)
            if delay_s == 0 and name not in ("base", "robot"):
                node.stdout.readline()
        yield


def run(file, duration_s, code=0):
    file.write_text(EXPERIMENT.replace("DURATION", str(duration_s)))
    summary, printed = runs.run(file, file.parent / "run", code=code)
    assert "ERROR" not in printed, printed  # of roscpp
    return summary, printed


def main():
    with tempfile.TemporaryDirectory() as scratch:
        file = pathlib.Path(scratch) / "types.yaml"
        with ros.master(pathlib.Path(scratch)):
            for name, text in (("other", OTHER), ("version", VERSION)):
                with nodes(name):
                    runs.assert_says(run(file, 20, code=3)[1], f"{text} ... [SL0508]")
                with nodes("right"), nodes(name, delay_s=2):
                    runs.assert_says(run(file, 8)[1], f"warning: {text}")
            with nodes("right", "base"):
                printed = run(file, 4)[1]
                runs.assert_says(printed, "node /base subscribes to '/go' as geometry_msgs/Twist and gets no command of "
                                          "type std_msgs/Float64MultiArray; write  message: geometry_msgs/Twist")
                assert "no subscriber" not in printed, printed
            with nodes("right", "robot"):  # The robot cannot connect to a wrong address of this node.
                printed = runs.spikeloop("run", file, "--out", file.parent / "run", "--force",
                                         env={**os.environ, "ROS_HOSTNAME": "no-such-host.invalid"})[1]
                runs.assert_says(printed, "other nodes cannot connect to this one")
                assert "no subscriber" not in printed, printed
            # The emergency stop works although a publisher of another type was connected first.
            with nodes("right", "no_button"), nodes("button", delay_s=2):
                summary, printed = run(file, 8)
                runs.assert_says(printed, "topic '/stop' carries std_msgs/Int64, not std_msgs/Bool; node /no_button "
                                          "publishes it; its messages are ignored")
                counters = summary["processes"]["experiment"]["counters"]
                assert counters["go.stops_emergency_stop"] == 1, counters


if __name__ == "__main__":
    sys.exit(main())
