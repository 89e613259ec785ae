#!/usr/bin/python3
"""Files with random faults, from seeds: bytes changed, cut, doubled, numbers replaced by extreme ones. Every program
that reads them must end soon, with success or one of our errors.

  random_files.py --files 500 --seed 1 [--kinds arena,vehicle]
"""

import argparse
import concurrent.futures
import pathlib
import random
import re
import shutil
import sys
import tempfile

import genpy
import rosbag
from sensor_msgs.msg import LaserScan

sys.path.append(str(pathlib.Path(__file__).parents[1] / "bag"))
import recording_writer  # noqa: E402
from hostile import EXPERIMENT, LONGEST_S, NETWORK, ROBOT, Answer, programs

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
BRAIN = """resolution: 0.1 ms
populations:
  input: {model: input, size: 100}
  noise: {model: poisson, size: 20, parameters: {rate: 100 Hz}}
  cells: {model: iaf_psc_exp, size: 100, parameters: {t_ref: 2 ms, tau_m: 10 ms, C_m: 250 pF, I_e: 300 pA}}
connections:
  - {from: input, to: cells, rule: one_to_one, weight: 500 pA, delay: 1 ms}
  - {from: noise, to: cells, rule: all_to_all, weight: 20 pA, delay: 0.5 ms}
  - {from: cells, to: cells, rule: pairs, pairs: [[0, 1], [99, 3]], weight: -30 pA, delay: 2 ms}
output: [cells]
"""
# A robot other than the vehicle, with elements that need memory or time.
MODEL = """<mujoco model="it">
  <option timestep="0.001" iterations="50"/>
  <size njmax="100" nconmax="50" nkey="1" nuser_geom="2"/>
  <visual><quality shadowsize="1024" offsamples="2" numslices="20"/><map znear="0.01" zfar="30"/></visual>
  <statistic center="0 0 0.6" extent="1.1"/>
  <asset>
    <hfield name="hills" nrow="10" ncol="20" size="2 2 0.5 0.1"/>
    <texture name="tiles" type="2d" builtin="checker" width="64" height="64" rgb1="1 1 1" rgb2="0 0 0"/>
    <material name="tiles" texture="tiles" texrepeat="4 4"/>
  </asset>
  <custom><numeric name="n" size="5" data="1 2"/></custom>
  <worldbody>
    <light pos="0 -1 3" dir="0.2 0.5 -1"/>
    <geom type="hfield" hfield="hills" pos="0 0 -1" material="tiles"/>
    <camera name="eye" pos="0 -2 1" fovy="50"/>
    <body name="cart" pos="0 0 0.4">
      <joint name="slider" type="slide" axis="1 0 0" range="-1.4 1.4" limited="true" damping="0.5"/>
      <geom type="box" size="0.12 0.08 0.05" mass="1" user="1 2"/>
      <site name="imu" size="0.01"/>
      <composite type="grid" count="3 3 1" spacing="0.05" offset="0 0 0.5"><geom size="0.01"/></composite>
    </body>
  </worldbody>
  <actuator><motor name="push" joint="slider" ctrlrange="-20 20" ctrllimited="true" gear="2"/></actuator>
  <sensor>
    <gyro site="imu"/><accelerometer site="imu"/><rangefinder site="imu"/>
    <user name="u" objtype="site" objname="imu" datatype="real" needstage="pos" dim="3"/>
  </sensor>
  <keyframe><key name="home" time="0"/></keyframe>
</mujoco>
"""
MODEL_ROBOT = """experiment: it
duration: 100 ms
sync: lockstep
robot: {simulator: mujoco, model: FILE, rate: 100 Hz}
nodes:
  joint: {node: ros_sensor, topic: /joint_states, message: sensor_msgs/JointState, fields: ["position[0]"]}
  motor: {node: ros_command, topic: /joint_commands, message: sensor_msgs/JointState, fields: {"effort[name=push]": 0}}
connections:
  - joint -> motor [1]
"""
# Values that replace numbers of a text.
EXTREMES = (b"0", b"-1", b"1e9", b"1e20", b"-1e20", b"1e-300", b"1e300", b"1e400", b"nan", b"inf", b"-inf", b"65536",
            b"999999999", b"2147483647", b"2147483648", b"4294967296", b"9223372036854775807", b"9223372036854775808")
NUMBER = re.compile(rb"(?<![\w.#])-?\d+\.?\d*(?:e-?\d+)?(?![\w.])")
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


def ros2_recording(path):
    """In SQLite, with metadata.yaml."""
    recording_writer.db3(path, [(i, recording_writer.scan(beams=100)) for i in range(20)])
    recording_writer.metadata(path.parent, [path.name])
    return path.read_bytes(), (path.parent / "metadata.yaml").read_bytes()


def originals(folder):
    """Kind: (a good file's bytes, its name, what reads it)."""
    def check(text, name):
        def use(place, file):
            shutil.copy(folder / "run/eye.h5", place / "eye.h5")
            (place / "it.yaml").write_text(text.replace("FILE", file.name))
            return Answer(SPIKELOOP, "check", "it.yaml", cwd=place)
        return name, use
    worlds = programs().parent / "share/spikeloop/worlds"

    def included(place, _):
        """The vehicle's file, by the world that is with it in the folder."""
        shutil.copy(worlds / "phototaxis.xml", place / "world.xml")
        return check(ROBOT, "world.xml")[1](place, pathlib.Path("world.xml"))

    def drawn(place, file):
        (place / "it.yaml").write_text(MODEL_ROBOT.replace("FILE", file.name))
        return Answer(SPIKELOOP, "run", "it.yaml", "--no-record", "--out", "run", "--render", "end.png",
                      "--render-size", "64x48", cwd=place)
    network = EXPERIMENT.replace("FILE", "eye.h5").replace(
        "  out:", "  net: {node: network, network: FILE}\n  out:").replace(
            "first ->", "first -> net [100] ->")
    (folder / "good.yaml").write_text(ROBOT.replace("FILE", "arena"))
    made = Answer(SPIKELOOP, "run", folder / "good.yaml", "--out", folder / "run")
    assert made.code == 0, made.text
    bag = ROBOT.replace("simulator: mujoco, world: FILE", "bag: FILE").replace("lockstep", "unpaced")

    (folder / "ros2").mkdir()
    sqlite, metadata = ros2_recording(folder / "ros2/it.db3")

    def in_folder(place, file):
        (place / "it.db3").write_bytes(sqlite)
        return check(bag, "metadata.yaml")[1](place, file)

    def in_run(place, file):
        shutil.copytree(folder / "run", place / "run")
        shutil.copy(file, place / "run" / file.name)
        return Answer(SPIKELOOP, "replay", place / "run", cwd=place)
    plain = (("it.yaml", lambda place, file: Answer(SPIKELOOP, "check", file, cwd=place)))
    return {
        "experiment": ((folder / "good.yaml").read_bytes(), *plain),
        "music": (MUSIC.encode(), "it.music", plain[1]),
        "network": (NETWORK.encode(), *check(network, "net.yaml")),
        "brain": (BRAIN.encode(), *check(network, "net.yaml")),
        **{world: ((worlds / f"{world}.xml").read_bytes(), *check(ROBOT, "world.xml"))
           for world in ("arena", "phototaxis", "t_maze", "lane")},
        "vehicle": ((worlds / "spikeloop_vehicle.xml").read_bytes(), "spikeloop_vehicle.xml", included),
        "model": (MODEL.encode(), *check(MODEL_ROBOT, "model.xml")),
        "drawn": (MODEL.encode(), "model.xml", drawn),
        "message": (MESSAGE.encode(), "robot/msg/Arm.msg",
                    lambda place, file: Answer(SPIKELOOP, "describe", file)),
        "recording": ((folder / "run/eye.h5").read_bytes(), *check(EXPERIMENT, "it.h5")),
        "messages": ((folder / "run/messages.mcap").read_bytes(), *check(bag, "it.mcap")),
        "bag": (ros1_bag(folder / "good.bag"), *check(bag, "it.bag")),
        "sqlite": (sqlite, *check(bag, "it.db3")),
        "metadata": (metadata, "metadata.yaml", in_folder),
        "resolved": ((folder / "run/resolved.json").read_bytes(), "resolved.json", in_run),
        "summary": ((folder / "run/summary.json").read_bytes(), "summary.json", in_run),
    }


def spoiled(data, dice):
    data = bytearray(data)
    for _ in range(dice.choice((1, 1, 2, 5, 20))):
        at = dice.randrange(len(data))
        kind = dice.randrange(6)
        numbers = list(NUMBER.finditer(data)) if kind == 5 else []
        if numbers:
            number = dice.choice(numbers)
            data[number.start():number.end()] = dice.choice(EXTREMES)
        elif kind == 0:
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
    parser.add_argument("--kinds", help="only these kinds of files, separated by commas")
    arguments = parser.parse_args()
    failed, refused, longest = [], 0, (0, "")
    with tempfile.TemporaryDirectory() as scratch, concurrent.futures.ThreadPoolExecutor(2) as pool:
        kinds = originals(pathlib.Path(scratch))
        for kind, good in kinds.items():
            assert answer_to(*good)[0] == 0, f"the {kind} is wrong from the beginning"
        if arguments.kinds:
            kinds = {kind: kinds[kind] for kind in arguments.kinds.split(",")}
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
