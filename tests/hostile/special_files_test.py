#!/usr/bin/python3
"""A pipe, a device, a folder or a file of wrong sizes where a file is expected: an error that names
it, soon, with 8 GB of memory."""

import concurrent.futures
import json
import os
import pathlib
import shutil
import sys
import tempfile

import h5py
import numpy as np

from hostile import EXPERIMENT, LONGEST_S, ROBOT, Answer, arena, programs

SPIKELOOP = programs() / "spikeloop"


def experiment(folder, text, file):
    path = folder / "it.yaml"
    path.write_text(text.replace("FILE", str(file)))
    return path


def with_network(file):
    return EXPERIMENT.replace("node: spike_playback, file: FILE", f"node: network, network: {file}")


def users():
    """Name: what reads a file, given its folder and the file."""
    def check(text):
        return lambda folder, file: Answer(SPIKELOOP, "check", experiment(folder, text, file))

    def check_world(part):
        def use(folder, file):
            (folder / "world.xml").write_text(part.replace("FILE", str(file)))
            return Answer(SPIKELOOP, "check", experiment(folder, ROBOT, "world.xml"))
        return use

    def message(folder, file):
        place = folder / "robot/msg"
        place.mkdir(parents=True)
        os.symlink(file, place / "Arm.msg")
        return Answer(SPIKELOOP, "describe", place / "Arm.msg")

    return {
        "experiment": lambda folder, file: Answer(SPIKELOOP, "check", link(folder, file, "a.yaml")),
        "music": lambda folder, file: Answer(SPIKELOOP, "check", link(folder, file, "a.music")),
        "recording": check(EXPERIMENT),
        "network": check(with_network("FILE")),
        "script": lambda folder, file: Answer(SPIKELOOP, "check", experiment(
            folder, with_network("FILE"), link(folder, file, "brain.py"))),
        "plug-in": lambda folder, file: Answer(SPIKELOOP, "check", experiment(
            folder, "plugins: [FILE]\n" + ROBOT.replace("FILE", "arena"), link(folder, file, "plugin.py"))),
        "bag": check(BAG),
        "world": check(ROBOT),
        "include": check_world(arena('<include file="FILE"/>')),
        "mesh": check_world(arena('<asset><mesh name="m" file="FILE"/></asset>')),
        "texture": check_world(arena(
            '<asset><texture name="t" type="2d" file="FILE"/></asset>')),
        "message": message,
        "fit": lambda folder, file: Answer(SPIKELOOP, "fit", "--spikes", file, "--target", file,
                                           "--out", folder / "w.json"),
    }


BAG = """experiment: it
sync: unpaced
robot: {bag: FILE}
nodes:
  scan: {node: ros_sensor, topic: /scan, message: LaserScan}
  out: {node: rate_encoder, rate_max: 100 Hz}
connections:
  - scan -> out [100]
"""


def link(folder, file, name):
    os.symlink(file, folder / name)
    return folder / name


def in_place_of(name, use, kind):
    """How long the answer takes."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        # MuJoCo takes the type of a mesh or a picture from its name.
        file = folder / {"mesh": "it.stl", "texture": "it.png"}.get(name, "it")
        if kind == "pipe":
            os.mkfifo(file)
        elif kind == "folder":
            file.mkdir()
        else:
            os.symlink("/dev/zero", file)
        answer = use(folder, file)
        try:
            return answer.refused()
        except AssertionError as error:
            raise AssertionError(f"{kind} in place of a {name}: {error}") from None


NOT_DRAWN = ("messages.mcap", "log.txt")  # no picture shows anything of them
DRAWN_SLOWLY = ("eye.h5", "turn.h5")  # pictures of what is not looked at here


def in_run_folder(names, kind, verb, run):
    """Files of a run's folder, for plot, replay and the next run."""
    with tempfile.TemporaryDirectory() as scratch:
        copy = pathlib.Path(scratch) / "run"
        shutil.copytree(run, copy)
        for name in names:
            (copy / name).unlink(missing_ok=True)
            if kind == "pipe":
                os.mkfifo(copy / name)
            elif kind == "deep":
                (copy / name).write_text('{"nodes":' + "[" * 500_000)
            else:
                os.symlink("/dev/zero", copy / name)
        if verb == "run":
            file = experiment(pathlib.Path(scratch), ROBOT, "arena")
            return Answer(SPIKELOOP, "run", file, "--out", copy, "--force").refused(*names)
        if verb == "plot":
            for name in DRAWN_SLOWLY:
                (copy / name).unlink()
        # A plot leaves out what it cannot read, and says so.
        answer = Answer(SPIKELOOP, verb, copy, cwd=scratch)
        assert not answer.trouble(), f"{kind} as {names}: {answer.command}: {answer.text[-2000:]}"
        for name in names if verb == "plot" else ():
            assert name in answer.text or name in NOT_DRAWN, f"{kind} as {name}: {answer.text[-2000:]}"
        return answer.seconds


def recordings(folder):
    """Of wrong types and sizes."""
    def write(name, width=100, dims=(3,), attributes=None):
        path = folder / name
        with h5py.File(path, "w") as file:
            file.attrs.update({"process": "p", "spikeloop_version": "1", "seed": np.uint64(1),
                               "spikeloop_format": np.uint32(1), "tick_ns": np.int64(1_000_000),
                               "complete": np.uint32(1)})
            group = file.create_group("spikes/out")
            file.create_group("signals")
            group.attrs.update({"width": np.uint32(width), "until_ns": np.int64(10**8),
                                "dropped": np.uint64(0), **(attributes or {})})
            for data, kind in (("timestamps_ns", np.int64), ("node_ids", np.uint64)):
                group.create_dataset(data, shape=dims, dtype=kind, chunks=(1024,), maxshape=(None,))
        return path
    huge = write("huge.h5", dims=(2**60,))
    arrays = [write(f"{key}.h5", attributes={key: np.arange(5_000, dtype=np.int64)})
              for key in ("width", "until_ns", "dropped")]
    texts = write("text.h5", attributes={"width": "three"})
    outside = folder / "outside.h5"
    with h5py.File(write("good.h5")) as good, h5py.File(outside, "w") as file:
        file.attrs.update(good.attrs)
        file.create_group("signals")
        file["spikes"] = h5py.ExternalLink(str(folder / "pipe"), "/spikes")
    os.mkfifo(folder / "pipe")
    return [huge, *arrays, texts, outside]


def messages(folder):
    """Definitions that nest, one into the other."""
    place = folder / "deep/msg"
    place.mkdir(parents=True)
    for i in range(40):
        (place / f"Twice{i}.msg").write_text(f"Twice{i + 1} a\nTwice{i + 1} b\n")
    (place / "Twice40.msg").write_text("float64 x\n")
    for i in range(2_000):
        (place / f"Chain{i}.msg").write_text(f"Chain{i + 1} a\n")
    (place / "Many.msg").write_text("".join(f"int8 f{i}\n" for i in range(100_000)))
    return [place / "Twice0.msg", place / "Chain0.msg", place / "Many.msg"]


def worlds(folder):
    parts = {
        "texture": arena('<asset><texture name="t" type="2d" builtin="flat" width="2000000000" '
                         'height="2000000000" rgb1="1 0 0"/></asset>'),
        "keys": arena('<size nkey="2000000000"/>'),
        "iterations": arena('<option iterations="2000000000" tolerance="0" solver="PGS"/>'),
    }
    for name, text in parts.items():
        (folder / f"{name}.xml").write_text(text)
    return [folder / f"{name}.xml" for name in parts]


def texts(folder):
    """Experiments that are too much of something."""
    head = "experiment: it\nnodes:\n"
    tail = "connections:\n  - a -> b [3]\n"
    many = {
        "nodes": head + "".join(f"  n{i}: {{node: clip}}\n" for i in range(50_000)) + tail,
        "connections": head + "  a: {node: clip}\n  b: {node: clip}\nconnections:\n"
        + "  - a -> b [3]\n" * 50_000,
        "chain": head + "  a: {node: clip}\nconnections:\n  - "
        + " -> ".join(f"n{i}" for i in range(100_000)) + "\n",
        "wrong": head + "".join(f"  n{i}: {{node: nothing}}\n" for i in range(9_000)) + tail,
        "brackets": "[" * 7_000_000,
        "aliases": "a0: &a0 [x, x]\n" + "".join(
            f"a{i + 1}: &a{i + 1} [{', '.join([f'*a{i}'] * 10)}]\n" for i in range(30)),
    }
    for name, text in many.items():
        (folder / f"{name}.yaml").write_text(text)
    return [folder / f"{name}.yaml" for name in many]


def written(folder):
    """What reads a file, and the file, of each one that is written here."""
    def check_in(text):
        return lambda file: Answer(
            SPIKELOOP, "check", experiment(file.with_suffix(""), text, file))

    pairs = []
    for part, make, use in (
            ("recordings", recordings, check_in(EXPERIMENT)),
            ("worlds", worlds, check_in(ROBOT)),
            ("messages", messages, lambda file: Answer(SPIKELOOP, "describe", file)),
            ("texts", texts, lambda file: Answer(SPIKELOOP, "check", file))):
        (folder / part).mkdir()
        for file in make(folder / part):
            file.with_suffix("").mkdir(exist_ok=True)
            pairs.append((use, file))
    return pairs


def recorded_run(folder):
    done = Answer(SPIKELOOP, "run", experiment(folder, ROBOT, "arena"), "--out", folder / "run")
    assert done.code == 0, done.text
    return folder / "run"


def longer_run(run, folder):
    copy = folder / "longer"
    shutil.copytree(run, copy)
    summary = json.loads((copy / "summary.json").read_text())
    (copy / "summary.json").write_text(json.dumps({**summary, "simulated_s": 1e9}))
    return Answer(SPIKELOOP, "replay", copy, cwd=folder).refused("its recordings end at")


def main():
    with tempfile.TemporaryDirectory() as scratch, \
            concurrent.futures.ThreadPoolExecutor(2) as pool:
        folder = pathlib.Path(scratch)
        run = recorded_run(folder)
        # Before the first program starts: a child holds HDF5's lock on what is open here until
        # its exec.
        made = written(folder)
        answers = [pool.submit(longer_run, run, folder)]
        for name, use in users().items():
            answers += [pool.submit(in_place_of, name, use, kind)
                        for kind in ("pipe", "device", "folder")]
        alone = ("resolved.json", "summary.json", "scan.h5", "trajectory.csv", "world.json")
        for kind in ("pipe", "device"):
            answers += [pool.submit(in_run_folder, [name], kind, "run", run) for name in (*alone, *NOT_DRAWN)]
            answers += [pool.submit(in_run_folder, names, kind, "replay", run)
                        for names in (*([name] for name in alone), NOT_DRAWN)]
            # A plot takes a second and more of the processor's time. It ends at what stands alone here.
            answers += [pool.submit(in_run_folder, names, kind, "plot", run) for names in (
                ["resolved.json"], ["scan.h5"], ["trajectory.csv", *NOT_DRAWN], ["summary.json", "world.json"])]
        answers += [pool.submit(in_run_folder, [name], "deep", verb, run)
                    for name in ("resolved.json", "summary.json") for verb in ("plot", "replay")]
        answers += [pool.submit(lambda use=use, file=file: use(file).refused())
                    for use, file in made]
        answers.append(pool.submit(lambda: Answer(
            SPIKELOOP, "fit", "nef_encoder", "--rates", "--points", "100000000").refused()))
        longest = max(answer.result() for answer in answers)
    print(f"{len(answers)} files are refused; the longest took {longest:.1f} s "
          f"(at most {LONGEST_S} s on a machine that does nothing else)")


if __name__ == "__main__":
    sys.exit(main())
