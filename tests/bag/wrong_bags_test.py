#!/usr/bin/python3
"""What spikeloop check says of a bag in the robot's place that does not fit."""

import pathlib
import sys
import tempfile

import rosbag
from geometry_msgs.msg import Twist
from std_msgs.msg import Float64

import bags
import runs


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
    print(number, "wrong bags are refused")


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
