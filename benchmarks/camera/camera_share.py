#!/usr/bin/python3
"""Processor time for a camera: 640 x 480 rgb8 at 30 Hz over ROS 1 into 1,200 channels.

Runs an experiment twice in real time, with images of this size and of 40 x 30 pixels. The difference is
the cost of large images: socket, message and averages. Prints the processor time of spikeloop-fused
as a fraction of a core, and the difference.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import time

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPOSITORY / "tests" / "fused"))

import ros  # noqa: E402  (a master of our own)

EXPERIMENT = """experiment: camera
duration: {seconds} s
tick: 1 ms
ros: 1
nodes:
  eye: {{node: ros_sensor, topic: /camera, message: sensor_msgs/Image, image: {{resize: [40, 30]}}}}
  encoder: {{node: temporal_contrast_encoder, threshold: 10}}
  rates: {{node: rate_window}}
connections:
  - eye -> encoder [1200] -> rates [2400]
"""

PUBLISH = """
import sys
import numpy as np
import rospy
from sensor_msgs.msg import Image

width, height = int(sys.argv[1]), int(sys.argv[2])
rospy.init_node("camera", disable_signals=True)
topic = rospy.Publisher("/camera", Image, queue_size=2)
pictures = []
for seed in range(4):
    data = np.random.default_rng(seed).integers(0, 256, 3 * width * height, dtype=np.uint8)
    pictures.append(Image(width=width, height=height, step=3 * width, encoding="rgb8",
                          data=data.tobytes()))
rate = rospy.Rate(30)
i = 0
try:
    while True:
        topic.publish(pictures[i % 4])
        i += 1
        rate.sleep()
except KeyboardInterrupt:
    pass
"""


def processor_seconds(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def parent_of(pid):
    return int(pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[1])


def fused_process(launcher):
    """The descendant that runs the graph."""
    for path in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if not (path / "cmdline").read_bytes().split(b"\0")[0].endswith(b"spikeloop-fused"):
                continue
            ancestor = int(path.name)
            while ancestor not in (0, launcher):
                ancestor = parent_of(ancestor)
            if ancestor == launcher:
                return int(path.name)
        except (OSError, ValueError):
            pass  # it has ended
    return None


def share(spikeloop, scratch, seconds, width, height):
    """Processor time a second of the process, once it runs."""
    file = scratch / "camera.yaml"
    file.write_text(EXPERIMENT.format(seconds=seconds + 6))
    with ros.program("/usr/bin/python3", "-c", PUBLISH, width, height):
        run = subprocess.Popen([spikeloop, "run", file, "--no-record", "--out",
                                scratch / f"run{width}"], stdout=subprocess.DEVNULL)
        watcher = threading.Timer(seconds + 60, run.kill)
        watcher.start()
        ros.until(lambda: fused_process(run.pid), "spikeloop-fused starting")
        pid = fused_process(run.pid)
        time.sleep(3)
        begin, before = time.monotonic(), processor_seconds(pid)
        time.sleep(seconds)
        result = (processor_seconds(pid) - before) / (time.monotonic() - begin)
        run.wait()
        watcher.cancel()
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", type=pathlib.Path,
                        default=REPOSITORY / "build" / "release" / "bin")
    parser.add_argument("--seconds", type=float, default=20)
    arguments = parser.parse_args()
    spikeloop = arguments.programs / "spikeloop"
    with tempfile.TemporaryDirectory() as folder:
        scratch = pathlib.Path(folder)
        with ros.master(scratch):
            small = share(spikeloop, scratch, arguments.seconds, 40, 30)
            large = share(spikeloop, scratch, arguments.seconds, 640, 480)
    print(f"pictures of  40 x  30: {100 * small:5.1f} % of a core")
    print(f"pictures of 640 x 480: {100 * large:5.1f} % of a core")
    print(f"a camera of 640 x 480: {100 * (large - small):5.1f} % of a core")


if __name__ == "__main__":
    main()
