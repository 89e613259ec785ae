#!/usr/bin/python3
"""Recordings whose definitions cannot be used, or belong to another version of a message; clocks that jump; what
`spikeloop check` reports of the messages of a recording."""

import pathlib
import re
import struct
import sys
import tempfile

import numpy as np

import bags
import recording_writer as writer
import runs
from formats_test import BEGIN, SECOND, VALUE, scans, values_of

SCAN = writer.full_definition("sensor_msgs/LaserScan")
IDL = "module sensor_msgs { module msg { struct LaserScan { float angle_min; }; }; };"
OWN = "the recording's definition of sensor_msgs/LaserScan cannot be used ({}); Spikeloop's own is used"

RANGE = """experiment: range
sync: unpaced
robot: {{bag: {}}}
nodes:
  scan: {{node: ros_sensor, topic: /range, message: sensor_msgs/Range, fields: [{}]}}
  encoder: {{node: rate_encoder, rate_max: 200 Hz}}
connections:
  - scan -> encoder [1]
"""


def usable_definitions(scratch):
    """No warning."""
    for name, text in {"CRLF": SCAN.replace("\n", "\r\n"), "without builtin_interfaces": SCAN.split("=" * 80)[0] + (
            "===\nMSG: std_msgs/Header\n" + writer.definition("std_msgs/Header")),
            "long names": SCAN.replace("MSG: std_msgs/", "MSG: std_msgs/msg/").replace("std_msgs/Header header", (
                "std_msgs/msg/Header header")), "comments": SCAN.replace("\n", "  # comment\n", 3)}.items():
        values, _, printed = values_of(scratch, writer.mcap(scratch / "x.mcap", scans(), schema=text))
        np.testing.assert_allclose(values, [VALUE] * 20, atol=1e-6)
        assert "warning" not in printed, (name, printed)


def unusable_definitions(scratch):
    """Spikeloop's own, with one warning."""
    cut = {"in the first line": SCAN[:20], "in a field": SCAN[:SCAN.index("range_min") + 3],
           "in Header": SCAN[:SCAN.index("frame_id") + 4], "after a field": SCAN[:SCAN.index("float32 scan_time")],
           "before Header": SCAN[:SCAN.index("====")]}
    cases = [(text, "ros2msg", "it is cut off") for text in cut.values()] + [
        (IDL, "ros2idl", "it is in the format 'ros2idl'"), ("", "ros2msg", "it is empty"),
        ("\r\n", "", "it is empty"), ("", "", "it is empty"),
        ("Definition of sensor_msgs/LaserScan", "ros2msg", "its line 1 cannot be read"),
        ("{\"title\": \"LaserScan\"}", "jsonschema", "it is in the format 'jsonschema'")]
    for text, encoding, reason in cases:
        recording = writer.mcap(scratch / "x.mcap", scans(), schema=text, encoding=encoding)
        values, _, printed = values_of(scratch, recording)
        np.testing.assert_allclose(values, [VALUE] * 20, atol=1e-6)
        assert printed.count("warning") == 1, printed
        runs.assert_says(printed, OWN.format(reason))
        checked = bags.spikeloop("check", scratch / "x.yaml")
        assert checked.count("warning: ") == 1 and "OK: 2 nodes" in checked, checked
        bags.spikeloop("check", "--strict", scratch / "x.yaml", code=2)
    # The type hash of the recorder proves that the version is the same.
    hash = next(word for word in bags.spikeloop("describe", "sensor_msgs/LaserScan").split() if "RIHS01_" in word)
    recording = writer.mcap(scratch / "x.mcap", scans(), schema=IDL, encoding="ros2idl", hash=hash)
    assert "warning" not in values_of(scratch, recording)[2]
    writer.mcap(scratch / "x.mcap", [(BEGIN, writer.scan()[:15])], schema=IDL, encoding="ros2idl")
    runs.refused("its definition cannot be used (it is in the format 'ros2idl'), and its messages do not fit Spikeloop's",
                 "check", scratch / "x.yaml")


def custom_type(scratch):
    """The user's file replaces a definition that cannot be used."""
    (scratch / "my_robot/msg").mkdir(parents=True)
    (scratch / "my_robot/msg/Sonar.msg").write_text("float64[] distances\n")
    sonar = writer.Cdr().array("d", [0.5] * 12).bytes()
    recording = writer.mcap(scratch / "x.mcap", [(BEGIN, sonar)], "/scan", "my_robot/Sonar", schema=IDL,
                            encoding="ros2idl")
    file = bags.experiment(scratch / "x.yaml", recording)
    text = file.read_text()
    file.write_text(text.replace("sensor_msgs/LaserScan", "my_robot/msg/Sonar.msg, fields: [distances]"))
    runs.run(file, scratch / "run")
    assert runs.recordings.signal(scratch / "run", "scan")[1].tolist() == [[0.5] * 12]
    file.write_text(text.replace("sensor_msgs/LaserScan", "my_robot/Sonar"))
    runs.refused("unknown message type 'my_robot/Sonar'", "check", file)


def other_versions(scratch):
    whole = writer.full_definition("sensor_msgs/Range")
    assert "float32 variance" in whole
    humble = "".join(line for line in whole.splitlines(keepends=True) if "variance" not in line)
    newer = whole.replace("float32 variance\n", "float32 variance\nfloat32 temperature\n")
    short, long = writer.humble_range(), writer.humble_range() + struct.pack("<ff", 0.25, 20)
    recordings = {"humble": writer.mcap(scratch / "humble.mcap", [(BEGIN, short)] * 3, "/range", "sensor_msgs/Range",
                                        schema=humble),
                  "newer": writer.mcap(scratch / "newer.mcap", [(BEGIN, long)] * 3, "/range", "sensor_msgs/Range",
                                       schema=newer),
                  "no definition": writer.db3(scratch / "humble.db3", [(BEGIN, short)] * 3, "/range",
                                              "sensor_msgs/Range", distribution="foxy"),
                  "IDL": writer.mcap(scratch / "idl.mcap", [(BEGIN, short)] * 3, "/range", "sensor_msgs/Range",
                                     schema=IDL, encoding="ros2idl")}
    file = scratch / "x.yaml"
    for name, recording in recordings.items():
        file.write_text(RANGE.format(recording, "range"))
        _, printed = runs.run(file, scratch / "run")
        assert runs.recordings.signal(scratch / "run", "scan")[1].tolist() == [[1.5]], name
        assert printed.count("warning") == (1 if name == "IDL" else 0), (name, printed)
        file.write_text(RANGE.format(recording, "variance"))
        if name == "newer":
            runs.run(file, scratch / "run")
            assert runs.recordings.signal(scratch / "run", "scan")[1].tolist() == [[0.25]]
        else:
            runs.refused("another version of sensor_msgs/Range: its messages have no field 'variance'; give the .msg "
                         "file of that version", "check", file)
    other = whole.replace("float32 range\n", "float64 range\n")
    for text, reason in ((other, "its field 'range' has another type"),
                         (whole.replace("min_range", "least_range"),
                          "its field 4 is 'least_range', ours is 'min_range'")):
        writer.mcap(scratch / "other.mcap", [(BEGIN, long)], "/range", "sensor_msgs/Range", schema=text)
        file.write_text(RANGE.format(scratch / "other.mcap", "range"))
        runs.refused(f"another version of sensor_msgs/Range: {reason}; give the .msg file of that version", "check",
                     file)


def clocks_that_jump(scratch):
    """(times of messages in s, ticks at which they are used, what is printed)"""
    now = BEGIN // SECOND
    cases = [([10, 10.5, now, now + 1], [1, 501, 1501], "from 10.5 s to 1700000000 s after 2 messages;"),
             ([now, now + 0.5, 20, 20.5, 21], [1, 501, 1001, 1501], "from 1700000000.5 s to 20 s after 2 messages;"),
             ([5, 6, 5 + now, 6, 7], [1, 1001, 2001], "(the first of 2 jumps);"),
             # A step of less than a second is one of NTP, and a day may have no message.
             ([5, 6, 5.5, 7], [1, 501, 1001, 2001], None), ([0, 12, 13], [1, 12001, 13001], None),
             # --use-sim-time
             ([0, now, now + 1], [1, 1001], "1 message is at time 0, before the first /clock, and the next time is "
                                            "1700000000 s; they are used at the beginning"),
             ([0, 0, 100, 101], [1, 1001], "2 messages are at time 0, before the first /clock, and the next time is "
                                            "100 s")]
    for times, ticks, warning in cases:
        recording = writer.mcap(scratch / "x.mcap", [(int(t * SECOND), writer.scan()) for t in times])
        _, found, printed = values_of(scratch, recording)
        assert list(found) == ticks, (times, found)
        assert printed.count("x.mcap': ") == (1 if warning else 0), printed
        if warning:
            runs.assert_says(printed, warning)
            runs.assert_says(bags.spikeloop("check", scratch / "x.yaml"), warning)


def long_gap(scratch):
    """It is kept, because the robot may have paused."""
    recording = writer.mcap(scratch / "x.mcap", [(t * SECOND, writer.scan()) for t in (1000, 1001, 4601, 4602)])
    _, ticks, printed = values_of(scratch, recording)
    assert list(ticks) == [1, 1001, 3601001, 3602001], ticks
    runs.assert_says(printed, "x.mcap': there is no message from 1 s to 3601 s")


def ros1_clock(scratch):
    """A simulation that starts again, recorded by rosbag in several chunks."""
    arena = bags.arena(6)
    times = [5, 5.05, 5.1, 0.05, 0.1, 0.15]
    recording = bags.write(scratch / "x.bag", [(int(t * SECOND), message) for t, message in zip(times, arena)],
                           chunk_threshold=200)
    runs.run(bags.experiment(scratch / "x.yaml", recording), scratch / "run")
    ticks, rows = runs.recordings.signal(scratch / "run", "scan")
    assert list(ticks // 1_000_000) == [1, 51, 101, 151, 201], ticks  # two messages share a tick
    np.testing.assert_allclose(rows, [bags.signal_of(arena[i]) for i in (0, 1, 3, 4, 5)], atol=1e-6)
    runs.assert_says(bags.spikeloop("check", scratch / "x.yaml"),
                     "its clock jumps from 5.1 s to 50 ms after 3 messages;")


def checks(scratch):
    """`check` reports what a run would report."""
    mixed = scans(0, 5) + [(BEGIN + 5 * SECOND, writer.scan())]
    bags.experiment(scratch / "x.yaml", writer.mcap(scratch / "x.mcap", mixed))
    runs.assert_says(bags.spikeloop("check", scratch / "x.yaml"),
                     "x.yaml:3:14: at 2.2 s: no message on topic '/scan' for 2 s", "OK: 2 nodes")
    # A recording of 20 h: the check does not take as long as a run.
    writer.mcap(scratch / "x.mcap", [(BEGIN, writer.scan()), (BEGIN + 72_000 * SECOND, writer.scan())])
    printed = bags.spikeloop("check", scratch / "x.yaml", timeout=60)
    assert re.search(r"x.yaml: the first \d[\d.]* s of 72000.001 s of the recording were checked", printed), printed
    # The third message is damaged.
    damaged = scans(0, 2) + [(BEGIN + SECOND // 10, writer.scan()[:30])] + scans(3, 5)
    bags.experiment(scratch / "x.yaml", writer.mcap(scratch / "x.mcap", damaged))
    runs.assert_says(bags.spikeloop("check", scratch / "x.yaml"), "could not be read and is left out")
    bags.spikeloop("check", "--strict", scratch / "x.yaml", code=2)
    # An image whose encoding changes.
    image = [writer.Cdr().add("i", 1).add("I", 0).text("camera").add("I", 2, 3).text(encoding).add("B", 0).add("I", 3)
             .array("B", [100] * 6).bytes() for encoding in ("mono8", "hsv9")]
    writer.mcap(scratch / "x.mcap", [(BEGIN + i * SECOND, data) for i, data in enumerate(image)], "/scan",
                "sensor_msgs/Image")
    bags.experiment(scratch / "x.yaml", scratch / "x.mcap", width=6)
    file = scratch / "x.yaml"
    file.write_text(file.read_text().replace("LaserScan", "Image"))
    runs.assert_says(bags.spikeloop("check", file, code=2), "'hsv9'")


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        usable_definitions(scratch)
        unusable_definitions(scratch)
        custom_type(scratch)
        other_versions(scratch)
        clocks_that_jump(scratch)
        long_gap(scratch)
        ros1_clock(scratch)
        checks(scratch)


if __name__ == "__main__":
    sys.exit(main())
