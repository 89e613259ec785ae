#!/usr/bin/python3
"""Recordings of lidars as users have them: what a sensor reads, and what it prints."""

import json
import math
import pathlib
import sys
import tempfile

import numpy as np
from sensor_msgs.msg import JointState, LaserScan

import bags
import runs

EXPERIMENT = """experiment: lidar
sync: lockstep
robot: {{bag: {bag}}}
nodes:
  sensor: {{node: ros_sensor, topic: {topic}, message: {message}{keys}}}
  encoder: {{node: rate_encoder}}
connections:
  - sensor -> encoder [{width}]
"""
STEP = 50_000_000  # ns, 20 Hz


def scan(ranges, first=-math.pi / 2, increment=None, low=0.0, high=10.0):
    increment = math.pi / (len(ranges) - 1) if increment is None else increment
    return LaserScan(ranges=list(ranges), angle_min=first, angle_increment=increment,
                     angle_max=first + increment * (len(ranges) - 1), range_min=low, range_max=high)


def value(ranges):
    """Of range_min 0 and range_max 10."""
    return np.asarray(ranges) / 5 - 1


class Recording:
    """A bag, and the last values that a sensor reads from it."""

    def __init__(self, folder, messages, topic="/scan"):
        self.folder, self.topic = folder, topic
        self.message = messages[0]._type
        self.bag = bags.write(folder / f"{len(list(folder.iterdir()))}.bag",
                              [(10**18 + i * STEP, message) for i, message in enumerate(messages)], topic)

    def experiment(self, width, keys=""):
        file = self.folder / "lidar.yaml"
        file.write_text(EXPERIMENT.format(bag=self.bag, topic=self.topic, message=self.message, width=width,
                                          keys=keys and f", {keys}"))
        return file

    def read(self, width, keys="", code=0):
        """(the last values, counters, warnings)"""
        out = self.folder / f"run-{len(list(self.folder.iterdir()))}"
        _, printed = runs.run(self.experiment(width, keys), out, code=code)
        warnings = [line for line in printed.splitlines() if "warning" in line]
        counters = json.loads((out / "summary.json").read_text())["counters"]
        return runs.recordings.signal(out, "sensor")[1][-1], counters, warnings


def beams_that_vary(folder):
    """A wall in front: a resampled scan shows it at the same angles, whatever the number of beams."""
    def wall(count):
        return np.minimum(2 / np.maximum(np.cos(np.linspace(-np.pi / 2, np.pi / 2, count)), 1e-9), 9)

    recording = Recording(folder, [scan(wall(359 + i % 3)) for i in range(40)])
    values, _, warnings = recording.read(19, "beams: 19, angles: [-60 deg, 60 deg]")
    edges = np.maximum(np.abs(np.linspace(-60, 60, 19)) - 60 / 18, 0)
    np.testing.assert_allclose(values, value(2 / np.cos(np.radians(edges))), atol=0.02)
    assert not warnings, warnings

    counts = [100 + (i % 5 == 4) - (i % 7 == 6) for i in range(40)]
    recording = Recording(folder, [scan(i + 0.01 * np.arange(n)) for i, n in enumerate(map(int, counts))])
    for width in (99, 100, 101):
        values, counters, warnings = recording.read(width)
        expected = np.full(width, np.nan)
        for i, count in enumerate(counts):
            expected[:count] = value(i + 0.01 * np.arange(count))[:width]
        np.testing.assert_allclose(values, np.clip(expected, -1, 1), atol=1e-6)
        assert len(warnings) == 1, warnings
        other = next(count for count in counts if count != width)
        runs.assert_says(warnings[0], f"node 'sensor': ... {other} values ... {width} channels ... 'beams' ... {width}")
        assert counters["sensor.cropped"] == sum(count > width for count in counts), counters
        assert counters["sensor.short_messages"] == sum(count < width for count in counts), counters


def ranges_that_are_not_set(folder):
    """pointcloud_to_laserscan sends range_min 0 and range_max inf or 3.4e38, cheap drivers 0 and 0."""
    for high in (math.inf, 3.4028234663852886e38, math.nan, 0.0):
        recording = Recording(folder, [scan([math.inf] * 5 + [2.0] * 5, high=high)] * 5)
        values, _, warnings = recording.read(10)
        np.testing.assert_allclose(values, [1] * 5 + [-0.6] * 5, atol=1e-6)
        assert len(warnings) == 1, warnings
        runs.assert_says(warnings[0], "node 'sensor': ... range_min 0 ... range_max ... 0 m ... 10 m ... 'range'")
        values, _, warnings = recording.read(10, "range: [1, 5]")
        np.testing.assert_allclose(values, [1] * 5 + [-0.5] * 5, atol=1e-6)
        assert not warnings, warnings


def fields_that_are_always_nan(folder):
    """Of a driver that knows no velocities, also if there are few messages."""
    message = JointState(name=["j1", "j3"], position=[1, 2], velocity=[0.5, math.nan])
    for count in (3, 60):
        for more, channel in ((', "position[name=j3]"', 0), ("", 0)):
            recording = Recording(folder, [message] * count, "/joint_states")
            none_usable = 7
            _, counters, warnings = recording.read(2 if more else 1, f'fields: ["velocity[name=j3]"{more}]',
                                                   0 if more else none_usable)
            assert len(warnings) == 1, warnings
            runs.assert_says(warnings[0], f"node 'sensor': ... 'velocity[name=j3]' ... channel {channel} ... nan: 0")
            assert counters["sensor.without_reading"] == (0 if more else count), counters


def keys_are_checked(folder):
    recording = Recording(folder, [scan([2.0] * 10)])
    for keys, width, expected in (
            ("beams: 5", 4, "gives 5 values ... 4 channels ... [5] ... [SL0505]"),
            ("beams: 0", 4, "'beams' ... [SL0203]"),
            ("angles: [-1 rad, 1 rad]", 4, "'angles' ... 'beams' ... [SL0104]"),
            ("beams: 4, angles: [-90, 90]", 4, "'angles': entry 1: '-90' has no unit ... [-90 deg, 90 deg] [SL0202]"),
            ("beams: 4, angles: [-90 deg]", 4, "'angles' ... [SL0105]"),
            ("beams: 4, angles: [170 deg, -170 deg]", 4, "'angles' ... [170 deg, 190 deg] [SL0206]"),
            ("beams: 4, angles: [-200 deg, 200 deg]", 4, "'angles' ... [-200 deg, 160 deg] [SL0203]"),
            ("range: [4, 1]", 10, "'range': minimum 4 ... maximum 1 ... [1, 4] [SL0206]"),
            ("range: [-1, 1]", 10, "'range' ... [SL0203]"),
            ("range: [0, 1], fields: [ranges]", 10, "'range' ... 'fields' ... [SL0208]"),
            ("beams: 4, fields: [ranges]", 4, "'beams' ... 'fields' ... [SL0208]")):
        file = recording.experiment(width, keys)
        runs.refused(f"{file}: ... {expected}", "check", file)


def recordings_of_one_length_are_checked(folder):
    file = Recording(folder, [scan([2.0] * 10)] * 30).experiment(9)
    runs.refused(f"{file}:8 ... 10 values ... 9 channels ... [10] ... [SL0505]", "check", file)


def files_of_both_kinds(folder):
    """The exported job has the keys, and its import too."""
    recording = Recording(folder, [scan([2.0] * 10)])
    file = recording.experiment(5, "beams: 5, angles: [-90 deg, 1 rad], range: [0, 4]")
    file.write_text(file.read_text().replace(f"robot: {{bag: {recording.bag}}}\n", "ros: 2\n")
                    .replace("lockstep", "realtime"))
    runs.spikeloop("export", file, "--out", folder / "job")
    text = (folder / "job/experiment.music").read_text()
    assert "beams=5\n" in text.replace(" ", "") and "-90 deg" in text, text
    runs.spikeloop("import", folder / "job/experiment.music", "--out", folder / "again.yaml")
    runs.assert_says((folder / "again.yaml").read_text(), "beams: 5", "range: [0, 4]", "angles: [-90 deg, 57.29577951308232 deg]")
    runs.spikeloop("check", folder / "again.yaml")


def joints_in_any_order(folder):
    """Each name keeps its channel; of a sensor by name nothing is printed."""
    def joints(**positions):
        return JointState(name=list(positions), position=list(positions.values()),
                          velocity=[-p for p in positions.values()])

    recording = Recording(folder, [joints(a=1.0, b=2.0), joints(b=20.0, a=10.0), joints(b=200.0)], "/joint_states")
    values, _, warnings = recording.read(4, "fields: [position, velocity]")
    np.testing.assert_array_equal(values, [10, 200, -10, -200])
    runs.assert_says(warnings[0], "node 'sensor': ... [a, b] ... [b, a] ... position[name=a]")
    values, _, warnings = recording.read(2, 'fields: ["position[name=a]", "velocity[name=b]"]')
    np.testing.assert_array_equal(values, [10, -200])
    assert not warnings, warnings


def main():
    for test in (beams_that_vary, ranges_that_are_not_set, fields_that_are_always_nan, keys_are_checked,
                 recordings_of_one_length_are_checked, files_of_both_kinds, joints_in_any_order):
        with tempfile.TemporaryDirectory() as folder:
            test(pathlib.Path(folder))
    print("lidars and joints are read as users have them")


if __name__ == "__main__":
    sys.exit(main())
