#!/usr/bin/python3
"""spikeloop.read_messages: every field of messages of ROS 1 as genpy reads it, of ROS 2 as struct packs it; a topic,
field or encoding that cannot be read is an error that lists what there is."""

import contextlib
import doctest
import pathlib
import struct
import sys
import tempfile
import warnings

import genpy
import numpy as np
import rosbag
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Image, JointState, LaserScan
from std_msgs.msg import Empty
from tf2_msgs.msg import TFMessage

import recording_writer as writer
import runs
from definitions_test import RANGE
from mcap_file import MAGIC, McapFile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(SOURCE / "python"))
import spikeloop  # noqa: E402
from spikeloop.run_folder import RunFolderError  # noqa: E402

BEGIN_S = 1_700_000_000
RANDOM = np.random.default_rng(1)


def transforms(count):
    message = TFMessage()
    for i in range(count):
        message.transforms.append(TransformStamped(child_frame_id=f"wheel {i}"))
        message.transforms[-1].transform.translation.y = i + 0.5
    return message


def diagnostics(i):
    """A text below two arrays."""
    return DiagnosticArray(status=[DiagnosticStatus(name=f"n{j}", values=[
        KeyValue(f"k{i}{j}{k}", "é") for k in range(j)]) for j in range(i)])


def odometry(i):
    message = Odometry(child_frame_id=f"base{i}")
    message.header.stamp = genpy.Time(BEGIN_S, 250_000_000 * i)
    message.pose.pose.position.x = RANDOM.normal()
    message.twist.covariance = list(RANDOM.normal(size=36))
    return message


MESSAGES = {
    "/scan": [LaserScan(ranges=RANDOM.normal(size=360)) for _ in range(3)],
    "/cheap_scan": [LaserScan(ranges=RANDOM.normal(size=size)) for size in (359, 360, 0, 361)],
    "/odom": [odometry(i) for i in range(3)],
    "/joints": [JointState(name=["a", "b"], position=[i, -i]) for i in range(3)],
    "/growing_joints": [JointState(name=["a", "b", "c"][:i], velocity=range(i)) for i in range(3)],
    "/tf": [transforms(count) for count in (2, 2)],
    "/growing_tf": [transforms(count) for count in (1, 0, 3)],
    "/diagnostics": [diagnostics(i) for i in range(4)],
    "/nothing": [Empty(), Empty()],
}


def value_of(message, path):
    """The field as numbers, texts and nested lists, by genpy's classes."""
    if not path:
        return message.to_sec() if isinstance(message, genpy.TVal) else message
    if isinstance(message, (list, tuple)):
        return [value_of(element, path) for element in message]
    return value_of(getattr(message, path[0]), path[1:])


def plain(value):
    if isinstance(value, np.ndarray):
        return [plain(element) for element in value]
    return value.item() if hasattr(value, "item") else list(value) if isinstance(value, (bytes, tuple)) else \
        [plain(element) for element in value] if isinstance(value, list) else value


def every_field_of_ros1(folder):
    bag = folder / "all.bag"
    with rosbag.Bag(str(bag), "w") as file:
        for topic, messages in MESSAGES.items():
            for i, message in enumerate(messages):
                file.write(topic, message, genpy.Time(BEGIN_S, 500_000_000 * i))
    count = 0
    with rosbag.Bag(str(bag)) as file:
        for topic, sent in MESSAGES.items():
            found = spikeloop.read_messages(bag, topic)
            assert (len(found), found.type) == (len(sent), sent[0]._type)
            np.testing.assert_allclose(found.times_s, 0.5 * np.arange(len(sent)), rtol=0, atol=1e-12)
            messages = [message for _, message, _ in file.read_messages(topic)]
            for path in found.fields:
                expected = [plain(value_of(message, path.split("."))) for message in messages]
                assert plain(found[path]) == expected, (topic, path, found[path], expected)
                count += 1
    assert count > 70, count
    for topic, path, shape, kind in (
            ("/scan", "ranges", (3, 360), "<f4"), ("/cheap_scan", "ranges", (4,), "O"), ("/odom", "header.seq", (3,), "<u4"),
            ("/odom", "twist.covariance", (3, 36), "<f8"), ("/joints", "name", (3, 2), "O"),
            ("/joints", "effort", (3, 0), "<f8"), ("/tf", "transforms.transform.translation.y", (2, 2), "<f8"),
            ("/growing_tf", "transforms.transform.rotation.w", (3,), "O")):
        values = spikeloop.read_messages(bag, topic, fields=path)[path]
        assert (values.shape, values.dtype) == (shape, np.dtype(kind)), (topic, path, values.shape, values.dtype)
    assert spikeloop.read_messages(bag, "/odom", ["pose.pose.position", "child_frame_id"]).fields == [
        "child_frame_id", "pose.pose.position.x", "pose.pose.position.y", "pose.pose.position.z"]
    return bag


def images(folder):
    """Images of several sizes, with rows that are longer than their pixels, and without defined colours. All encodings
    are in encodings_test.py."""
    colours = RANDOM.integers(0, 256, (2, 3, 3), dtype=np.uint8)
    padded = np.concatenate([colours.reshape(2, 9), np.zeros((2, 7), dtype=np.uint8)], axis=1).tobytes()
    bgra = np.concatenate([colours[..., ::-1], np.full((2, 3, 1), 9, np.uint8)], axis=2)
    flow = RANDOM.normal(size=(2, 3, 2)).astype(np.float32)
    cases = {"padded": ("rgb8", 16, padded, colours), "last_row": ("rgb8", 16, padded[:-7], colours),
             "alpha": ("8UC4", 12, bgra.tobytes(), np.concatenate([colours, bgra[..., 3:]], axis=2)),
             "flow": ("32FC2", 24, flow.tobytes(), flow)}
    bag = folder / "images.bag"
    with rosbag.Bag(str(bag), "w") as file:
        def write(topic, second, width, height, encoding, step, data):
            file.write(topic, Image(height=height, width=width, encoding=encoding, step=step, data=data),
                       genpy.Time(BEGIN_S + second))
        for name, (encoding, step, data, _) in cases.items():
            for second in range(2):
                write(f"/{name}", second, 3, 2, encoding, step, data)
        for second, width in enumerate((1, 2)):
            write("/sizes", second, width, 1, "mono8", width, bytes(width))
        for second, encoding in enumerate(("mono8", "hsv9")):
            write("/unknown", second, 1, 1, encoding, 1, bytes(1))
        write("/short", 0, 2, 2, "mono8", 2, bytes(3))
    for name, (_, _, _, expected) in cases.items():
        found = spikeloop.read_messages(bag, f"/{name}").images()
        assert found.dtype == expected.dtype, (name, found.dtype)
        np.testing.assert_array_equal(found, [expected, expected], err_msg=name)
    assert [image.shape for image in spikeloop.read_messages(bag, "/sizes").images()] == [(1, 1), (1, 2)]
    refused(lambda: spikeloop.read_messages(bag, "/unknown").images(), "topic '/unknown', message 2: images with the encoding "
            "'hsv9' cannot be read")
    refused(lambda: spikeloop.read_messages(bag, "/short").images(), "message 1: it has 3 bytes; 2 x 2 pixels with the encoding "
            "mono8 and a step of 2 have 4")


def record(op, content):
    return struct.pack("<BQ", op, len(content)) + content


def text(value):
    return struct.pack("<I", len(value)) + value


def mcap(path, kind, definition, messages, encoding=b"cdr"):
    head = record(3, struct.pack("<H", 1) + text(kind) + text(b"ros2msg") + text(definition))
    head += record(4, struct.pack("<HH", 1, 1) + text(b"/arm") + text(encoding) + text(b""))
    body = b"".join(record(5, struct.pack("<HIQQ", 1, i, i * 10**9, i * 10**9) + data) for i, data in enumerate(messages))
    path.write_bytes(MAGIC + record(1, text(b"ros2") + text(b"test")) + head + body +
                     record(15, struct.pack("<I", 0)) + record(2, struct.pack("<QQI", 0, 0, 0)) + MAGIC)
    return path


DEFINITION = b"""bool on
float64 angle
builtin_interfaces/Time at
string name
int16[3] fixed
int64[] many
Part[] parts
""" + b"=" * 80 + b"""
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
""" + b"=" * 80 + b"""
MSG: my_robot/Part
uint8 kind
float32 size
"""


def every_field_of_ros2(folder):
    """Numbers stand at multiples of their size, counted from behind the first four bytes."""
    def message(i):
        return b"\0\1\0\0" + struct.pack("<?7xdiI", i % 2, i / 4, i, 500_000_000) + \
            struct.pack("<I4s3h2xI", 4, b"arm\0", i, -i, 7, 2) + struct.pack("<4x2qI", i, -(1 << 40), 2) + \
            struct.pack("<B3xfB3xf", 1, 0.5, 2, i)
    arm = spikeloop.read_messages(mcap(folder / "arm.mcap", b"my_robot/msg/Arm", DEFINITION, map(message, range(3))), "/arm")
    expected = {"on": [False, True, False], "angle": [0, 0.25, 0.5], "at": [0.5, 1.5, 2.5], "name": ["arm"] * 3,
                "fixed": [[i, -i, 7] for i in range(3)], "many": [[i, -(1 << 40)] for i in range(3)],
                "parts.kind": [[1, 2]] * 3, "parts.size": [[0.5, i] for i in range(3)]}
    assert {path: plain(arm[path]) for path in arm.fields} == expected, arm.fields
    assert arm.type == "my_robot/Arm" and arm["on"].dtype == bool and arm["many"].dtype == np.int64
    cut = mcap(folder / "cut.mcap", b"my_robot/msg/Arm", DEFINITION, [message(0), message(1)[:-4]])
    refused(lambda: spikeloop.read_messages(cut, "/arm"), f"'{cut}': topic '/arm', message 2: message of ")
    whole = message(1)
    ends = {}  # fields of a message that ends after a field, by its size
    for size in range(len(whole)):  # none is read beyond its end
        short = mcap(folder / "short.mcap", b"my_robot/msg/Arm", DEFINITION, [whole[:size]])
        try:
            ends[size] = spikeloop.read_messages(short, "/arm").fields
        except RunFolderError as error:
            assert "message of " in str(error), (size, str(error))
    assert [ends[size] for size in (5, 20, 28, 36, 42, 68)] == [list(expected)[:count] for count in range(1, 7)], ends
    other = mcap(folder / "json.mcap", b"my_robot/msg/Arm", DEFINITION, [b"{}"], b"json")
    refused(lambda: spikeloop.read_messages(other, "/arm"), "encoded as 'json' and defined as 'ros2msg'")


def refused(action, *expected):
    try:
        action()
    except RunFolderError as error:
        for part in expected:
            assert part in str(error), (part, str(error))
        return
    raise AssertionError(f"accepted: {expected}")


def errors(bag):
    refused(lambda: spikeloop.read_messages(bag, "/scna"), "has no topic '/scna'; its topics: ", "/scan (sensor_msgs/LaserScan)",
            "[SL0507]")
    refused(lambda: spikeloop.read_messages(bag, "/scan", fields=["rangs"]), "no field 'rangs'; did you mean 'ranges'?")
    refused(lambda: spikeloop.read_messages(bag, "/odom")["pose.pose"], "no number or text 'pose.pose'", "pose.pose.position.x")
    refused(lambda: spikeloop.read_messages(bag, "/odom").images(), "not sensor_msgs/Image")
    refused(lambda: spikeloop.read_messages(bag.with_name("none.bag"), "/odom"), "none.bag")
    assert spikeloop.read_topics(bag)["/odom"] == "nav_msgs/Odometry"


def example_of_the_page(folder):
    (folder / "explorer.yaml").write_text(runs.spikeloop("new")[0])
    runs.spikeloop("run", "-q", "explorer.yaml", cwd=folder)
    with contextlib.chdir(folder):
        failed, tried = doctest.testfile(str(SOURCE / "docs/run-folder.md"), module_relative=False)
    assert failed == 0 and tried == 8, (failed, tried)


def messages_of_a_run(folder):
    """As the independent reader of MCAP finds them."""
    runs.run(runs.new_experiment(folder / "explorer.yaml", sync="lockstep", duration="1 s"), folder / "run")
    run = spikeloop.open_run(folder / "run")
    assert run.topics() == {"/scan": "sensor_msgs/LaserScan", "/cmd_vel": "geometry_msgs/Twist"}, run.topics()
    file = McapFile(folder / "run/messages.mcap")
    for topic, path in (("/scan", "ranges"), ("/cmd_vel", "linear.x")):
        found, sent = run.messages(topic), file.of(topic)
        np.testing.assert_array_equal(np.rint(found.times_s * 1e9), [time for time, _ in sent])
        np.testing.assert_array_equal(found[path], [value_of(message, path.split(".")) for _, message in sent])
    refused(lambda: run.messages("/scan", node="wheels"), "node 'wheels' has no messages of topic '/scan'; nodes with this topic: scan")
    (folder / "run/messages.mcap").unlink()
    refused(lambda: run.messages("/scan"), "messages.mcap' is missing: ", "--no-record", "--layout fused")


def warned(action):
    """Returns (result, texts of its warnings). Each warning must refer to a line of this file."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = action()
    assert all(one.filename == __file__ for one in caught), caught
    return result, [str(one.message) for one in caught]


def older_versions(folder):
    """Humble's Range, which lacks the last field, is read with both definitions and from the file of a run."""
    whole = writer.full_definition("sensor_msgs/Range")
    humble = whole.replace("float32 variance\n", "\n")
    for name, definition in (("humble", humble), ("jazzy", whole), ("empty", "")):
        file = writer.mcap(folder / f"{name}.mcap", [(0, writer.humble_range(1.5)), (10**9, writer.humble_range(2.5))], "/range",
                           "sensor_msgs/Range", schema=definition)
        found, texts = warned(lambda file=file: spikeloop.read_messages(file, "/range"))
        assert found["range"].tolist() == [1.5, 2.5] and found.fields[-1] == "range", (name, found.fields)
        assert len(texts) == (name == "empty"), texts
        refused(lambda file=file: spikeloop.read_messages(file, "/range", "variance"), "has no field 'variance'")
        (folder / "x.yaml").write_text(RANGE.format(file, "range"))
        runs.run(folder / "x.yaml", folder / "run")
        kept, texts = warned(lambda: spikeloop.open_run(folder / "run").messages("/range"))
        assert kept["range"].tolist() == [1.5, 2.5] and kept.fields == found.fields and not texts, (kept.fields, texts)
        schemas = str(McapFile(folder / "run/messages.mcap").schemas)
        assert "float32 min_range" in schemas and "variance" not in schemas, schemas


def warnings_of_files(folder):
    """Reading a file issues the same warnings as a run, once."""
    scans = [(i * 10**9, writer.scan()) for i in range(3)]
    cases = {"IDL": ({"schema": "module x {};", "encoding": "ros2idl"}, "definition of sensor_msgs/LaserScan cannot be used (it is in "
                     "the format 'ros2idl'); Spikeloop's own is used"),
             "cut off": ({"schema": writer.full_definition("sensor_msgs/LaserScan")[:300]}, "cannot be used (it is cut off)"),
             "not ended": ({"end": b""}, "was not ended: only its first 2 s can be read"),
             "gap": ({"messages": [*scans, (100 * 10**9, writer.scan())]}, "there is no message from 2 s to 100 s")}
    for name, (options, expected) in cases.items():
        file = writer.mcap(folder / "x.mcap", options.pop("messages", scans), **options)
        found, texts = warned(lambda file=file: spikeloop.read_messages(file, "/scan"))
        assert len(texts) == 1 and expected in texts[0], (name, texts)
        assert (found["ranges"] == 2).all() and len(found) >= 3, name
    cut = mcap(folder / "arm.mcap", b"my_robot/msg/Arm", DEFINITION.replace(b"Part[] parts\n", b""),
               [b"\0\1\0\0" + bytes(64)])
    _, texts = warned(lambda: spikeloop.read_messages(cut, "/arm"))
    assert len(texts) == 1 and "have more bytes than the definition of my_robot/Arm in the recording describes; fields after " \
        "'many' are left out" in texts[0], texts
    for name, definition, why in (("idl", b"module x {};", "its line 1 cannot be read"), ("empty", b"", "it is empty")):
        file = mcap(folder / f"{name}.mcap", b"my_robot/msg/Arm", definition, [bytes([0, 1, 0, 0]) + bytes(64)])
        refused(lambda file=file: spikeloop.read_messages(file, "/arm"), "definition of my_robot/Arm cannot be used, and Spikeloop has "
                "none that fits: ", why)
    refused(lambda: spikeloop.read_messages(folder / "x.mcap", "/scan", node="scan"), "was not written by a run")
    parts = folder / "parts"
    parts.mkdir()
    for number in (0, 2):
        writer.mcap(parts / f"drive_{number}.mcap", [(number * 10**9, writer.scan())])
    _, texts = warned(lambda: spikeloop.read_topics(parts))
    assert len(texts) == 1 and "part 1 is missing" in texts[0], texts


def main():
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        bag = every_field_of_ros1(folder)
        errors(bag)
        images(folder)
        every_field_of_ros2(folder)
        older_versions(folder)
        warnings_of_files(folder)
        messages_of_a_run(folder)
        (folder / "page").mkdir()
        example_of_the_page(folder / "page")


if __name__ == "__main__":
    sys.exit(main())
