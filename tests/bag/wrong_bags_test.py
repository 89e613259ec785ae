#!/usr/bin/python3
"""What spikeloop check says of a bag in the robot's place that does not fit."""

import pathlib
import sys
import tempfile

import numpy as np
import rosbag
from geometry_msgs.msg import Twist
from std_msgs.msg import Float64

import bags
import runs

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "python"))
import spikeloop  # noqa: E402
from spikeloop.run_folder import RunFolderError  # noqa: E402


def other_version(path):
    """A scan as a later ROS might have it."""
    with rosbag.Bag(str(path), "w") as bag:
        message = bags.arena(1)[0]
        buffer = bags_bytes(message)
        class Other(type(message)):
            _md5sum = "0123456789abcdef0123456789abcdef"
        bag.write("/scan", (message._type, buffer, Other._md5sum, Other), bags.genpy.Time(1, 0),
                  raw=True)
    return path


def bags_bytes(message):
    import io
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def cases(scratch):
    """(experiment, what is said)"""
    file = scratch / "x.yaml"
    good = bags.write(scratch / "good.bag", [(10**9, message) for message in bags.arena(3)])
    with rosbag.Bag(str(good), "a") as bag:
        bag.write("/speed", Float64(1), bags.genpy.Time(2, 0))
    twist = bags.write(scratch / "twist.bag", [(10**9, Twist())])
    (scratch / "text.bag").write_text("this is text")
    whole = good.read_bytes()
    (scratch / "cut.bag").write_bytes(whole[:len(whole) // 2])
    other_version(scratch / "other.bag")

    def of(bag, **keys):
        return lambda: bags.experiment(file, bag, **keys)

    def text(old, new, bag="good.bag"):
        def make():
            bags.experiment(file, bag)
            written = file.read_text()
            assert old in written, old
            file.write_text(written.replace(old, new))
        return make

    yield of("none.bag"), f"{file}:3:14: key 'bag': ... '{scratch}/none.bag'; ... [SL0108]"
    yield of("text.bag"), f"{file}:3:14: '{scratch}/text.bag' ... .mcap ... .bag ... [SL0109]"
    yield of("cut.bag"), f"{file}:3:14: '{scratch}/cut.bag' is damaged: "
    yield text("/scan,", "/scna,"), (f"{file}:5:35: key 'topic': the recording has no topic /scna; did "
                                     "you mean '/scan'?; it has /scan (sensor_msgs/LaserScan), "
                                     "/speed (std_msgs/Float64)")
    yield text("/scan,", "/nothing_like_it,"), (
        f"{file}:5:35: key 'topic': the recording has no topic /nothing_like_it; it has /scan "
        "(sensor_msgs/LaserScan), /speed (std_msgs/Float64)")
    yield of(twist.name), (f"{file}:5:51: key 'message': the recording's topic /scan carries "
                           "geometry_msgs/Twist, not sensor_msgs/LaserScan; write  message: "
                           "geometry_msgs/Twist")
    yield of("other.bag"), (f"{file}:5:51: key 'message': the recording's topic /scan carries another "
                            "version of sensor_msgs/LaserScan: its md5 sum is "
                            "0123456789abcdef0123456789abcdef, ours is "
                            "90c7ef2dc6895d81024acba2ac42f369; 'rosbag fix' makes it the version "
                            "of ROS Noetic")
    yield of("good.bag", width=7), f"{file}:8:13: "
    yield text("bag}", "bag, world: arena.xml}"), (
        f"{file}:3:24: robot: key 'world' is for a robot that is simulated, and the bag stands in "
        "its place; leave one of the two out [SL0208]")
    yield text("bag}", "bag, wrld: arena.xml}"), f"{file}:3:24: robot: unknown key 'wrld'; known: bag"
    yield of("good.bag", sync="realtime\nros: 1"), (
        f"{file}:4:14: key 'bag': a bag stands in the place of robot and ROS; leave  ros  out [SL0208]")


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        number = 0
        for make, expected in cases(scratch):
            make()
            printed = bags.spikeloop("check", scratch / "x.yaml",
                                     code=4 if "cut.bag" in expected or "text.bag" in expected else 2)
            runs.assert_says(printed, f"error: {expected}")
            number += 1
        bags.experiment(scratch / "x.yaml", "good.bag", width=7)
        assert "12" in bags.spikeloop("check", scratch / "x.yaml", code=2)
        bags.experiment(scratch / "x.yaml", "good.bag")
        bags.spikeloop("check", scratch / "x.yaml")
        runs.refused("x.yaml:3:14: an exported job has no bag in the robot's place; write  ros: 1, and play it "
                     "with  rosbag play", "export", scratch / "x.yaml", "--out", scratch / "job")
        own_folder(scratch)
        damaged_bags(scratch)
    print(number, "wrong bags are refused")


def messages_in(path):
    """Returns the number of messages of a bag, or the error."""
    try:
        return len(spikeloop.read_messages(path, "/scan"))
    except RunFolderError as error:
        assert str(path) in str(error), error
        return str(error)


def damaged_bags(scratch):
    """A damaged bag is read or refused, for any bytes."""
    bag = scratch / "damaged.bag"
    for compression in (rosbag.Compression.NONE, rosbag.Compression.BZ2, rosbag.Compression.LZ4):
        messages = [(i * 10**7, message) for i, message in enumerate(bags.arena(200))]
        whole = bags.write(bag, messages, compression=compression, chunk_threshold=2000).read_bytes()
        assert messages_in(bag) == 200
        for part in range(1, 20):
            bag.write_bytes(whole[:13 + (len(whole) - 13) * part // 20])
            error = messages_in(bag)
            assert error.startswith(f"'{bag}' is damaged: ") and error.endswith(
                "'rosbag check' and 'rosbag reindex' may help; if the error remains, no message can be recovered [SL0109]"), (part, error)
        random, refused = np.random.default_rng(1), 0
        for trial in range(200):
            wrong = bytearray(whole)
            # Half of the damaged bytes are after the messages.
            place = random.integers(13, len(whole)) if trial % 2 else len(whole) - 1 - random.integers(1500)
            wrong[place] = random.integers(256)
            bag.write_bytes(wrong)
            refused += messages_in(bag) != 200
        assert refused > 10, refused
    # The header has no index position, as before rosbag closes the file.
    index = whole.index(b"index_pos=") + 10
    bag.write_bytes(whole[:index] + bytes(8) + whole[index + 8:])
    assert messages_in(bag) == (f"'{bag}' has no index, because its recording was not ended; write  rosbag reindex {bag} "
                                "[SL0109]")
    bag.write_bytes(whole.replace(b"#ROSBAG V2.0", b"#ROSBAG V1.2"))
    runs.assert_says(messages_in(bag), f"is a bag of a format before 2.0; write  rosbag filter {bag} NEW.bag True")


def own_folder(scratch):
    """A run empties its folder first."""
    bags.spikeloop("run", scratch / "x.yaml", "--out", scratch / "run")
    bags.experiment(scratch / "again.yaml", "run/messages.mcap")
    runs.refused(f"again.yaml:3:14: key 'bag': the recording {scratch}/run/messages.mcap lies in the run "
                 "folder, which a run empties; give another folder with --out [SL0109]",
                 "run", scratch / "again.yaml", "--out", scratch / "run")
    assert (scratch / "run/messages.mcap").exists()


if __name__ == "__main__":
    sys.exit(main())
