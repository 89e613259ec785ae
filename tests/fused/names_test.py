#!/usr/bin/python3
"""Topics get other names on the command line, as each ROS writes it: a run with a robot of its own, beside a
robot that has the usual names and must not be driven; what means nothing is refused."""

import contextlib
import json
import pathlib
import signal
import subprocess
import sys
import tempfile

import yaml

import ros
import runs

NAMES = ("/scan:=/front/scan", "cmd_vel:=front/wheels")
AS_WRITTEN = {"1": NAMES, "2": ("--ros-args", "-r", NAMES[0], "--remap", NAMES[1])}
NODE = {"1": ("__name:=brain",), "2": ("--ros-args", "-r", "__node:=brain")}


def path_in(folder):
    return [(float(row["x_m"]), float(row["y_m"])) for row in runs.recordings.table(folder / "trajectory.csv")]


@contextlib.contextmanager
def other_robot(version, folder):
    """Gives its path once it is over, as (x, y)."""
    path = []
    with open(folder.with_suffix(".log"), "w+", encoding="utf-8") as said, subprocess.Popen(
            [str(runs.programs() / "spikeloop-robot"), "--ros", version, "--node-name", "other", "--out", str(folder),
             "--ros-args", "-p", "use_sim_time:=true", "--log-level", "info"], stderr=said) as robot:
        try:
            ros.until(lambda: (folder / "trajectory.csv").exists(), "the other robot's start")
            yield path
            assert robot.poll() is None, robot.returncode
        finally:
            robot.send_signal(signal.SIGINT)
            robot.wait(60)
        said.seek(0)
        words = said.read()
        assert "warning: '--log-level info' (behind --ros-args) means nothing to this robot" in words, words
        assert "use_sim_time" not in words, words
    path += path_in(folder)


def drive(scratch, version, layout, names):
    """Of a run with a robot of its own."""
    file = runs.new_experiment(scratch / "explorer.yaml", ros=version, duration="3 s")
    nodes = list(yaml.safe_load(file.read_text())["nodes"])
    file.write_text(f"layout: {{first: [{nodes[0]}], rest: [{', '.join(nodes[1:])}]}}  # which --layout replaces\n"
                    + file.read_text())
    folder = scratch / f"{layout}-{version}"
    summary, printed = runs.run(file, folder, "--layout", layout, *names)
    assert "robot" in summary["processes"], printed
    assert summary["distance_m"] > 0.1 and summary["scans"] > 40, summary
    return folder


def refused(scratch):
    file = runs.new_experiment(scratch / "explorer.yaml", ros="2")
    alone = runs.new_experiment(scratch / "alone.yaml")
    for said, where, *words in (
            ("'-p rate:=5' (behind --ros-args) means nothing to a run, whose settings stand in its file; leave it "
             "out, or end ROS's arguments by --", file, "--ros-args", "-p", "rate:=5"),
            ("'--log-level info' (behind --ros-args) means nothing", file, "--ros-args", "--log-level", "info", "--"),
            ("'-r scan' (behind --ros-args) gives no name; write -r NAME:=VALUE, as in -r /scan:=/front/scan", file,
             "--ros-args", "-r", "scan"),
            ("'-r' (behind --ros-args) gives no name", file, "--ros-args", "-r"),
            ("'__log:=/tmp/log' means nothing here", file, "__log:=/tmp/log"),
            ("'/fr ont' ... ROS 2 ", file, "/scan:=/fr ont"),
            ("'__name:=brain' names a node, and this run has several; leave it out", file, "--layout", "separate",
             "__name:=brain"),
            ("'/scan:=/front/scan' is for nodes of ROS, and the file has none; leave it out", alone, NAMES[0])):
        runs.refused(said, "run", where, "--out", scratch / "refused", *words)
        assert not (scratch / "refused").exists(), words


def music(folder):
    """A .music file, that of the run before, gives every section what its command line says."""
    def dry_run(*words):
        done = subprocess.run([runs.SPIKELOOP, "run", str(folder / "experiment.music"), "--dry-run", *words],
                              capture_output=True, text=True, check=False)
        return done.returncode, done.stdout.count("ros_arguments=/scan:=/front/scan\n"), done.stderr
    assert dry_run(NAMES[0])[:2] == (0, 6), dry_run(NAMES[0])
    assert dry_run()[:2] == (0, 0)
    assert "'__name:=brain' names a node" in dry_run("__name:=brain")[2]


def time_of_ros(scratch):
    """use_sim_time, which launch files give all nodes."""
    file = runs.new_experiment(scratch / "clock.yaml", ros="2", duration="1 s")
    for value, sync in (("true", "sim_time"), ("false", "realtime")):
        folder = scratch / f"clock-{value}"
        runs.run(file, folder, "--ros-args", "-p", f"use_sim_time:={value}")
        assert json.loads((folder / "resolved.json").read_text())["sync"] == sync


def two_pairs(scratch):
    """Two robots with two loops, at once, as the launch file of docs/ros2.md starts them: nothing is shared."""
    file = runs.new_experiment(scratch / "pair.yaml", ros="2", duration="4 s")
    lines = [line for line in file.read_text().splitlines() if not line.startswith("robot:")]
    file.write_text("\n".join(lines).replace("/scan", "scan").replace("/cmd_vel", "cmd_vel") + "\n")
    robots, loops = [], []
    try:
        for seed, name in ((1, "left"), (2, "right")):
            names = ["--ros-args", "-r", f"__ns:=/{name}", "-r", "/clock:=clock", "-r", "/tf:=tf", "-r",
                     "/tf_static:=tf_static"]
            robots.append(subprocess.Popen([runs.programs() / "spikeloop-robot", "--ros", "2", "--seed", str(seed),
                                            "--out", scratch / f"robot-{name}", *names]))
            loops.append(subprocess.Popen([runs.SPIKELOOP, "run", file, "--out", scratch / f"loop-{name}", *names, "-p",
                                           "use_sim_time:=true"], stderr=subprocess.PIPE, text=True))
        for loop in loops:
            said = loop.communicate(timeout=240)[1]
            assert loop.returncode == 0, said
    finally:
        for loop in loops:
            if loop.poll() is None:
                loop.send_signal(signal.SIGINT)
                loop.wait(60)
        for robot in robots:
            robot.send_signal(signal.SIGINT)
            robot.wait(60)
    paths = {name: path_in(scratch / f"robot-{name}") for name in ("left", "right")}
    for name, path in paths.items():
        summary = json.loads((scratch / f"loop-{name}" / "summary.json").read_text())
        assert summary["distance_m"] > 0.1, summary
        for x, y in path_in(scratch / f"loop-{name}"):
            assert min((x - a) ** 2 + (y - b) ** 2 for a, b in path) < 0.05 ** 2, (name, x, y)
    (x, y), (a, b) = paths["left"][0], paths["right"][0]
    assert (x - a) ** 2 + (y - b) ** 2 > 0.5 ** 2, "the two robots begin in different places"


def main():
    for version in "12":
        with tempfile.TemporaryDirectory() as scratch, ros.place(version, pathlib.Path(scratch)):
            scratch = pathlib.Path(scratch)
            with other_robot(version, scratch / "other") as path:
                drive(scratch, version, "fused", (*NAMES, *NODE[version]))
                music(drive(scratch, version, "separate", AS_WRITTEN[version]))
            assert len(path) > 10 and max(abs(x - path[0][0]) + abs(y - path[0][1]) for x, y in path) < 1e-3, path[-1]
            if version == "2":
                time_of_ros(scratch)
                two_pairs(scratch)
        print(f"over ROS {version} robots are driven by the names that the command line gives their topics")
    with tempfile.TemporaryDirectory() as scratch:
        refused(pathlib.Path(scratch))


if __name__ == "__main__":
    sys.exit(main())
