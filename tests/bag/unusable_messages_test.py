#!/usr/bin/python3
"""Recordings whose messages have no value, or cannot be read: check and run report the same, once, with and without
the number of channels in the connection."""

import math
import pathlib
import shutil
import sys
import tempfile

import numpy as np

import recording_writer as writer
import runs

SECOND = 10**9
BEGIN = 1_700_000_000 * SECOND
NAN = math.nan
VALUE = 2 * (2.0 - 0.1) / (10 - 0.1) - 1  # docs/messages.md, of a beam of 2 m
SCAN, IMAGE, JOINTS = "sensor_msgs/LaserScan", "sensor_msgs/Image", "sensor_msgs/JointState"
UNKNOWN = "SL0307"


def recording(path, messages, **options):
    """Writes 20 messages per second."""
    return writer.mcap(path, [(BEGIN + i * SECOND // 20, data) for i, data in enumerate(messages)], **options)


def experiment(scratch, bag, sensor, width="", more=""):
    file = scratch / "x.yaml"
    file.write_text(f"""sync: unpaced
robot: {{bag: {bag}}}
nodes:
  s: {{node: ros_sensor, topic: /scan, {sensor}}}
  c: {{node: ros_command, topic: /cmd, message: std_msgs/Float64MultiArray, max_age: 0 s}}
{more}connections:
  - s -> c{f" [{width}]" if width else ""}
""")
    return file


def check_and_run(scratch, file, code, *expected, warnings=None):
    """Requires that `check` and `run` end with this code and print the texts. Returns the values of the sensor."""
    shutil.rmtree(scratch / "run", ignore_errors=True)
    for words in (("check", file), ("run", file, "--out", scratch / "run", "--force")):
        printed = "".join(runs.spikeloop(*words, code=code))
        runs.assert_says(printed, *expected)
        assert UNKNOWN not in printed, printed
        for text in expected:
            assert printed.count(text.split(" ... ")[0]) == 1, f"twice: {text}\n{printed}"
        if warnings is not None:
            assert printed.count("warning: ") == warnings, printed
    return runs.recordings.signal(scratch / "run", "s")[1] if (scratch / "run/s.h5").exists() else None


def errors_without_width(scratch):
    """A connection without a number of channels has the same error about the message or key as one with it."""
    recording(scratch / "odd.mcap", [writer.image("8UC2", 2, 1, bytes(4))] * 3, kind=IMAGE)
    recording(scratch / "scan.mcap", [writer.scan()] * 3)
    writer.db3(scratch / "sonar.db3", [(BEGIN, writer.scan())] * 3, kind="my_robot/Sonar", distribution="foxy")
    for width in ("", 12):
        for bag, sensor, text in [
                ("sonar.db3", f"message: {SCAN}", "carries my_robot/Sonar, not sensor_msgs/LaserScan; Spikeloop does "
                 "not know its type; write the path of its .msg file [SL0508]"),
                ("odd.mcap", f"message: {IMAGE}", "x.yaml:4:3: node 's': topic '/scan': ... '8UC2' ... [SL0511]"),
                ("scan.mcap", f"message: {SCAN}, fields: [rangs]", "x.yaml:4:79: field path 'rangs' ... [SL0504]"),
                ("scan.mcap", f"message: {SCAN}, range: [4, 0]", "x.yaml:4:78: key 'range': ... [SL0206]"),
                ("scan.mcap", f"message: {SCAN}, image: {{resize: [4, 3]}}", "x.yaml:4:78: 'image' ... [SL0504]"),
                ("scan.mcap", "message: sensor_msgs/Imu", "x.yaml:4:48: key 'message': ... [SL0508]"),
                ("none.mcap", f"message: {SCAN}", "x.yaml:2:14: key 'bag': ... [SL0108]")]:
            check_and_run(scratch, experiment(scratch, bag, sensor, width), 2, text)


def unusable_without_width(scratch):
    """Recordings with only damaged or empty messages have the exit code of a run that received such messages."""
    swapped = [writer.scan(limits=(5, 0.1))] * 4
    for name, messages, kind, texts in [
            ("swapped", swapped, SCAN, ["'s' was usable (malformed: 4)", "range_min 5 ... 'range' ... [SL0509]"]),
            ("short", [writer.image("rgb8", 3, 2, bytes(10))] * 4, IMAGE,
             ["'s' was usable (malformed: 4)", "its step is 5 bytes ... [SL0509]"]),
            ("empty", [writer.scan(beams=0)] * 4, SCAN, ["'s' was usable (without_reading: 4)", "brought no reading"]),
            ("silent", [writer.scan()] * 4, f"{SCAN}, fields: [intensities]", ["brought no reading in 'intensities"]),
            ("mixed", [writer.scan(beams=0), *swapped], SCAN, ["'s' was usable (malformed: 4, without_reading: 1)"])]:
        recording(scratch / f"{name}.mcap", messages, kind=kind.split(",")[0])
        for width in ("", 12):
            check_and_run(scratch, experiment(scratch, f"{name}.mcap", f"message: {kind}", width), 7, *texts)
    recording(scratch / "names.mcap", [writer.joints(["left", "right"], [1, 2])] * 4, kind=JOINTS)
    check_and_run(scratch, experiment(scratch, "names.mcap", f"message: {JOINTS}, fields: ['position[name=lft]']"), 7,
                  "'s' was usable (without_reading: 4)", "'position[name=lft]', but has the names [left, right]")


def later_messages_have_the_width(scratch):
    recording(scratch / "late.mcap", [writer.scan(beams=0), writer.scan(limits=(5, 0.1)), *[writer.scan()] * 8])
    values = check_and_run(scratch, experiment(scratch, "late.mcap", f"message: {SCAN}"), 0)
    np.testing.assert_allclose(values, np.full((8, 12), VALUE), atol=1e-6)
    skip = 'fields: [{path: "ranges[2:4]", nan: skip}]'
    recording(scratch / "skip.mcap", [writer.scan(ranges=[1, 1, NAN, 1])] * 3 + [writer.scan(ranges=[1, 2, 3, 4])])
    values = check_and_run(scratch, experiment(scratch, "skip.mcap", f"message: {SCAN}, {skip}"), 0)
    np.testing.assert_allclose(values, [[3, 4]])


def images_of_two_sizes(scratch):
    """No width fits them; the error proposes one size."""
    recording(scratch / "sizes.mcap", [writer.image("mono8", 2, 1, bytes(2)), writer.image("mono8", 3, 1, bytes(3))],
              kind=IMAGE)
    for width, code in (("", 2), (2, 2), (3, 2)):
        check_and_run(scratch, experiment(scratch, "sizes.mcap", f"message: {IMAGE}", width), code,
                      "or give images of several sizes one size, as in  image: {resize: [32, 24]} ... [SL0505]")
    values = check_and_run(scratch, experiment(scratch, "sizes.mcap", f"message: {IMAGE}, image: {{resize: [1, 1]}}"), 0)
    assert values.shape == (2, 1), values


def blind_channels(scratch):
    """One blind beam or pixel: the others work, and the warning names it and the line to write."""
    depth = writer.image("16UC1", 2, 2, bytes([9, 0, 9, 0, 0, 0, 9, 0]))
    recording(scratch / "beam.mcap", [writer.scan(ranges=[NAN, 2, 2])] * 30)
    recording(scratch / "pixel.mcap", [depth] * 30, kind=IMAGE)
    pixels = f"message: {IMAGE}, image: {{range: [0, 9]}}"
    for bag, sensor, name, blind, good in [("beam.mcap", f"message: {SCAN}", "'ranges[0]'", 0, VALUE),
                                           ("pixel.mcap", pixels, "'pixel (0, 1)'", 2, 1)]:
        stands = check_and_run(scratch, experiment(scratch, bag, sensor), 0,
                               f"node 's': ... {name}, so channel {blind} has no value; ... as in initial:",
                               "no command was sent")
        assert np.isnan(stands[-1][blind]) and np.isfinite(np.delete(stands[-1], blind)).all()
        drives = check_and_run(scratch, experiment(scratch, bag, sensor + ", initial: -0.5"), 0,
                               f"node 's': ... {name}, so channel {blind} keeps its initial value -0.5", warnings=1)
        np.testing.assert_allclose(np.delete(drives[-1], blind), good, atol=1e-6)
        assert drives[-1][blind] == -0.5
        assert runs.run(scratch / "x.yaml", scratch / "run")[0]["counters"]["c.commands"] > 0


def surplus_joints(scratch):
    """Joints beyond the connection are counted, and named in one warning."""
    recording(scratch / "joints.mcap", kind=JOINTS, messages=[
        writer.joints(["a", "b"], [1, 2]), writer.joints(["c"], [3]), writer.joints(["a"], [4])] * 3)
    file = experiment(scratch, "joints.mcap", f"message: {JOINTS}, fields: [position]")
    values = check_and_run(scratch, file, 0, "brought 3 values ... 2 channels ... position[name=NAME], or write [3]",
                           warnings=1)
    np.testing.assert_allclose(values[:4], [[1, 2], [4, 2], [1, 2], [4, 2]])
    counters = runs.run(file, scratch / "run")[0]["counters"]
    assert (counters["s.cropped"], counters["s.short_messages"]) == (3, 0), counters


def one_of_two_sensors(scratch):
    """A command that waits for a useless sensor is never sent, directly connected or not."""
    between = "  e: {node: rate_encoder}\n  d: {node: linear_readout, weights: uniform}\n"
    good = "  t: {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan, range: [0, 9]}\n"
    recording(scratch / "swapped.mcap", [writer.scan(limits=(5, 0.1))] * 4)
    file = experiment(scratch, "swapped.mcap", f"message: {SCAN}, beams: 12, timeout: 1 s", 12, good + between)
    text = file.read_text()
    for connections in ("s, t -> c [24]", "s, t -> e [24] -> d [24] -> c [24]"):
        file.write_text(text.replace("s -> c [12]", connections).replace(between, between * ("-> e" in connections)))
        check_and_run(scratch, file, 7, "no command was sent: none of the 4 messages of 's' was usable (malformed: 4)")


def times(scratch):
    recording(scratch / "good.mcap", [writer.scan()] * 3)
    writer.mcap(scratch / "zero.mcap", [(0, writer.scan())] * 4)
    check_and_run(scratch, experiment(scratch, "zero.mcap", f"message: {SCAN}"), 0,
                  "zero.mcap': all 4 messages are at time 0 ... --use-sim-time", warnings=1)
    # Unsorted rows of SQLite are not a jump of the clock.
    rows = [(BEGIN + i * SECOND, writer.scan(ranges=[i + 1.0])) for i in (3, 0, 2, 4, 1)]
    writer.db3(scratch / "rows.db3", rows)
    sensor = f"message: {SCAN}, fields: [ranges]"
    values = check_and_run(scratch, experiment(scratch, "rows.db3", sensor), 0, warnings=0)
    np.testing.assert_allclose(values[:, 0], [1, 2, 3, 4, 5])


def no_complete_chunk(scratch):
    records = writer.channel("/scan", SCAN) + writer.message(BEGIN, writer.scan())
    whole = writer.MAGIC + writer.record(1, writer.text("ros2") + writer.text("test"))
    for name, data in (("head", whole), ("chunk", whole + writer.chunk(records, "", records)[:200])):
        (scratch / f"{name}.mcap").write_bytes(data)
        check_and_run(scratch, experiment(scratch, f"{name}.mcap", f"message: {SCAN}"), 4,
                      f"{name}.mcap' was not ended ... no complete chunk ... record it again")


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        for part in (errors_without_width, unusable_without_width, later_messages_have_the_width, images_of_two_sizes,
                     blind_channels, surplus_joints, one_of_two_sensors, times, no_complete_chunk):
            part(scratch)
            print(part.__name__)


if __name__ == "__main__":
    sys.exit(main())
