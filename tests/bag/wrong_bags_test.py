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

    yield of("none.bag"), (f"{file}:3:14: key 'bag': there is no bag '{scratch}/none.bag'; write "
                           "its path, from where this file lies")
    yield of("text.bag"), (f"{file}:3:14: '{scratch}/text.bag' is neither an MCAP file nor a "
                           "bag of ROS 1; write the path of a .mcap or .bag file")
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
                            "version of sensor_msgs/LaserScan ("
                            "0123456789abcdef0123456789abcdef, ours is "
                            "90c7ef2dc6895d81024acba2ac42f369); 'rosbag fix' makes it the version "
                            "of ROS Noetic")
    yield of("good.bag", width=7), f"{file}:8:13: "
    yield text("bag}", "bag, world: arena.xml}"), (
        f"{file}:3:24: robot: key 'world' is for a robot that is simulated, and the bag stands in "
        "its place; leave one of the two out")
    yield text("bag}", "bag, wrld: arena.xml}"), f"{file}:3:24: robot: unknown key 'wrld'; known: bag"
    yield of("good.bag", sync="realtime\nros: 1"), (
        f"{file}:4:14: key 'bag': a bag stands in the place of robot and ROS; leave  ros  out")


def main():
    spikeloop = runs.programs() / "spikeloop"
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        number = 0
        for make, expected in cases(scratch):
            make()
            printed = bags.spikeloop(spikeloop, "check", scratch / "x.yaml",
                                     code=4 if "cut.bag" in expected or "text.bag" in expected else 2)
            assert f"error: {expected}" in printed, f"expected:\n{expected}\nprinted:\n{printed}"
            number += 1
        bags.experiment(scratch / "x.yaml", "good.bag", width=7)
        assert "12" in bags.spikeloop(spikeloop, "check", scratch / "x.yaml", code=2)
        bags.experiment(scratch / "x.yaml", "good.bag")
        bags.spikeloop(spikeloop, "check", scratch / "x.yaml")
        printed = bags.spikeloop(spikeloop, "export", scratch / "x.yaml", "--out", scratch / "job", code=2)
        assert ("x.yaml:3:14: an exported job has no bag in the robot's place; write  ros: 1, and play it "
                "with  rosbag play") in printed, printed
        own_folder(spikeloop, scratch)
    print(number, "wrong bags are refused")


def own_folder(spikeloop, scratch):
    """A run empties its folder first."""
    bags.spikeloop(spikeloop, "run", scratch / "x.yaml", "--out", scratch / "run")
    bags.experiment(scratch / "again.yaml", "run/messages.mcap")
    printed = bags.spikeloop(spikeloop, "run", scratch / "again.yaml", "--out", scratch / "run",
                             code=2)
    assert (f"again.yaml:3:14: key 'bag': the recording {scratch}/run/messages.mcap lies in the run "
            "folder, which a run empties; give another folder with --out") in printed, printed
    assert (scratch / "run/messages.mcap").exists()


if __name__ == "__main__":
    sys.exit(main())
