#!/usr/bin/python3
"""Files with random faults, from seeds: bytes changed, cut, doubled. Whatever reads them ends soon,
with an answer of ours. A file that is still good may run.

  random_files.py --files 500 --seed 1
"""

import argparse
import concurrent.futures
import pathlib
import random
import shutil
import sys
import tempfile

import genpy
import rosbag
from sensor_msgs.msg import LaserScan

from hostile import EXPERIMENT, LONGEST_S, NETWORK, ROBOT, Answer, arena, programs

SPIKELOOP = programs() / "spikeloop"
MUSIC = """stoptime=4
music_timestep=0.002
[source]
np=1
binary=zmq_cont_adapter
message_type=FloatArray
zmq_addr=ipc:///tmp/in
initial=0.5
[encoder]
np=1
binary=rate_encoder
rate_max=200
[decoder]
np=1
binary=linear_readout_decoder
weights=uniform
[sink]
np=1
binary=cont_zmq_adapter
message_type=FloatArray
zmq_addr=ipc:///tmp/out
source.out -> encoder.in [3]
encoder.out -> decoder.in [3]
decoder.out -> sink.in [2]
"""
MESSAGE = """# of a robot
std_msgs/Header header
int32 COUNT=3
float64[3] joints
geometry_msgs/Pose[] poses
string name
"""


def ros1_bag(path):
    with rosbag.Bag(str(path), "w") as bag:
        for i in range(20):
            bag.write("/scan", LaserScan(range_max=10, ranges=[1 + i] * 100), genpy.Time(1, i))
    return path.read_bytes()


def originals(folder):
    """Kind: (a good file's bytes, its name, what reads it)."""
    def check(text, name):
        def use(place, file):
            shutil.copy(folder / "run/eye.h5", place / "eye.h5")
            (place / "it.yaml").write_text(text.replace("FILE", file.name))
            return Answer(SPIKELOOP, "check", "it.yaml", cwd=place)
        return name, use
    network = EXPERIMENT.replace("FILE", "eye.h5").replace(
        "  out:", "  net: {node: network, network: FILE}\n  out:").replace(
            "first ->", "first -> net [100] ->")
    (folder / "good.yaml").write_text(ROBOT.replace("FILE", "arena"))
    made = Answer(SPIKELOOP, "run", folder / "good.yaml", "--out", folder / "run")
    assert made.code == 0, made.text
    bag = ROBOT.replace("simulator: mujoco, world: FILE", "bag: FILE").replace("lockstep", "unpaced")

    def in_run(place, file):
        shutil.copytree(folder / "run", place / "run")
        shutil.copy(file, place / "run" / file.name)
        return Answer(SPIKELOOP, "replay", place / "run", cwd=place)
    plain = (("it.yaml", lambda place, file: Answer(SPIKELOOP, "check", file, cwd=place)))
    return {
        "experiment": ((folder / "good.yaml").read_bytes(), *plain),
        "music": (MUSIC.encode(), "it.music", plain[1]),
        "network": (NETWORK.encode(), *check(network, "net.yaml")),
        "world": (arena().encode(), *check(ROBOT, "world.xml")),
        "message": (MESSAGE.encode(), "robot/msg/Arm.msg",
                    lambda place, file: Answer(SPIKELOOP, "describe", file)),
        "recording": ((folder / "run/eye.h5").read_bytes(), *check(EXPERIMENT, "it.h5")),
        "messages": ((folder / "run/messages.mcap").read_bytes(), *check(bag, "it.mcap")),
        "bag": (ros1_bag(folder / "good.bag"), *check(bag, "it.bag")),
        "resolved": ((folder / "run/resolved.json").read_bytes(), "resolved.json", in_run),
        "summary": ((folder / "run/summary.json").read_bytes(), "summary.json", in_run),
    }


def spoiled(data, dice):
    data = bytearray(data)
    for _ in range(dice.choice((1, 1, 2, 5, 20))):
        at = dice.randrange(len(data))
        kind = dice.randrange(5)
        if kind == 0:
            data[at] = dice.randrange(256)
        elif kind == 1:
            data[at:at + 8] = dice.choice((b"\xff" * 8, b"\0" * 8, b"\xff\xff\xff\x7f\0\0\0\0"))
        elif kind == 2:
            data = data[:max(1, at)]
        elif kind == 3:
            piece = data[at:at + dice.randrange(1, 200)]
            data[at:at] = piece * dice.choice((1, 2, 100))
        else:
            data[at:at + 1] = dice.choice((b"[", b"{", b"999999999999", b"-1", b"nan", b"\"", b"&a *a",
                                           b"<", b"..", b"\r\n\t"))
    return bytes(data)


def one(number, seed, kinds):
    dice = random.Random(f"{seed} {number}")
    kind = dice.choice(sorted(kinds))
    data, name, use = kinds[kind]
    return kind, *answer_to(spoiled(data, dice), name, use)


def answer_to(data, name, use):
    """Exit code, seconds, and what no user should see."""
    with tempfile.TemporaryDirectory() as scratch:
        file = pathlib.Path(scratch) / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(data)
        try:
            answer = use(pathlib.Path(scratch), file)
            trouble = answer.trouble() and f"{answer.trouble()}\n{answer.text[-1500:]}"
            return answer.code, answer.seconds, trouble
        except AssertionError as error:
            return None, 0, str(error)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--files", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first file")
    arguments = parser.parse_args()
    failed, refused, longest = [], 0, (0, "")
    with tempfile.TemporaryDirectory() as scratch, concurrent.futures.ThreadPoolExecutor(2) as pool:
        kinds = originals(pathlib.Path(scratch))
        for kind, good in kinds.items():
            assert answer_to(*good)[0] == 0, f"the {kind} is wrong from the beginning"
        numbers = range(arguments.first, arguments.first + arguments.files)
        for number, answer in zip(numbers, pool.map(lambda n: one(n, arguments.seed, kinds),
                                                    numbers)):
            kind, code, seconds, trouble = answer
            refused += code != 0
            longest = max(longest, (seconds, f"{kind} {number}"))
            if trouble:
                failed.append(f"{kind} {number}: {trouble}")
                print(failed[-1], flush=True)
    print(f"{arguments.files} files: {refused} refused, {arguments.files - refused} still good; the "
          f"longest took {longest[0]:.1f} s ({longest[1]}), at most {LONGEST_S} s on a machine that "
          "does nothing else")
    assert not failed, f"{len(failed)} of {arguments.files}"
    assert refused > arguments.files / 4, "too few faults"


if __name__ == "__main__":
    sys.exit(main())
