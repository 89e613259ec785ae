"""Experiments and bags for the tests beside this file."""

import genpy
import numpy as np
import rosbag
import runs
from sensor_msgs.msg import LaserScan

BEAMS = 12

EXPERIMENT = """experiment: bag
sync: {sync}
robot: {robot}
nodes:
  scan: {{node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}}
  encoder: {{node: rate_encoder, rate_max: 200 Hz}}
connections:
  - scan -> encoder [{width}]
"""


def experiment(path, bag, sync="unpaced", width=BEAMS, more=""):
    path.write_text(more + EXPERIMENT.format(sync=sync, width=width, robot=f"{{bag: {bag}}}"))
    return path


def scan(ranges):
    message = LaserScan(range_min=0.1, range_max=10, ranges=list(ranges))
    message.header.frame_id = "laser"
    return message


def signal_of(message):
    """What docs/nodes.md says of beams that are neither too near nor too far."""
    low, high = np.float32(message.range_min), np.float32(message.range_max)
    ranges = np.array(message.ranges, dtype=np.float32).astype(float)
    return 2 * (ranges - float(low)) / (float(high) - float(low)) - 1


def arena(number):
    """Scans that no two of are the same."""
    generator = np.random.default_rng(1)
    return [scan(generator.uniform(0.5, 9.5, BEAMS)) for _ in range(number)]


def write(path, messages, topic="/scan", **options):
    """As rosbag record does: (time in ns, message)."""
    with rosbag.Bag(str(path), "w", **options) as bag:
        for time, message in messages:
            bag.write(topic, message, genpy.Time(time // 10**9, time % 10**9))
    return path


def spikeloop(*words, **options):
    """All that is printed."""
    return "".join(runs.spikeloop(*words, **options))
