#!/usr/bin/python3
"""Over ROS: a robot that was killed and that the master still knows, a process that is killed, a
sensor that another robot fills, path and collisions of another robot, a process that hangs."""

import contextlib
import itertools
import json
import math
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import xmlrpc.client

import ros
import runs
import jobs  # tests/support/jobs.py; runs.py adds its folder to the path

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "safety"))
import robots  # noqa: E402  (that are no part of Spikeloop)

HANGING = """import spikeloop, time

@spikeloop.node(inputs={"in": "signal"}, outputs={"out": spikeloop.Signal(same_as="in")})
def hanging(step):
    if step.begin > 500_000_000:
        time.sleep(60)
    if step.changed("in"):
        step.write("out", step.inputs["in"])
"""


@contextlib.contextmanager
def ros_master(scratch):
    """An environment with a master of its own."""
    with ros.master(scratch) as uri:
        yield dict(os.environ), xmlrpc.client.ServerProxy(uri)


def scans(master):
    return [nodes for topic, nodes in master.getSystemState("/test")[2][0] if topic == "/scan"]


def robot(master, environment, *options):
    process = subprocess.Popen([runs.programs() / "spikeloop-robot", *options], env=environment,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    ros.until(lambda: scans(master), "robot")
    return process


def dead_robot(scratch):
    file = runs.new_experiment(scratch / "explorer.yaml", ros="1", duration="1 s")
    with ros_master(scratch) as (environment, master):
        process = robot(master, environment)
        process.kill()
        process.wait()
        assert scans(master), "the master has forgotten it by itself"
        _, said = runs.spikeloop("run", file, "--out", scratch / "alone", env=environment)
        runs.assert_says(said, "warning: the ROS master has /", "but it does not answer: a robot of our own is started")
        assert (scratch / "alone/trajectory.csv").exists(), said


def living_robot(scratch):
    """Nothing is started beside it; of a width that is not its own a warning names node and numbers."""
    file = runs.new_experiment(scratch / "other.yaml", ros="1", duration="1 s")
    text = file.read_text()
    robot_line = next(line for line in text.splitlines() if line.startswith("robot:"))
    file.write_text(text.replace(robot_line, "").replace("sectors [100]", "sectors [90]"))
    with ros_master(scratch) as (environment, master):
        process = robot(master, environment)
        try:
            _, said = runs.spikeloop("run", file, "--out", scratch / "narrow", env=environment)
            runs.assert_says(said, "warning: node 'scan': ... 100 values ... 90 channels ... 'beams' ... 90 ... [100]")
        finally:
            process.send_signal(signal.SIGINT)
            process.wait()


def living_robot_of_ros2(scratch):
    """One that sends /scan already is used, and goes on afterwards."""
    file = runs.new_experiment(scratch / "used.yaml", ros="2", duration="3 s")
    trajectory = scratch / "going-on/trajectory.csv"
    with ros.domain(), ros.program(runs.programs() / "spikeloop-robot", "--ros", "2", "--out",
                                   trajectory.parent) as process:
        ros.until(lambda: trajectory.exists() and trajectory.stat().st_size > 2000, "a path")
        summary, printed = runs.run(file, scratch / "used")
        runs.assert_says(printed, "/scan is published already: no robot is started")
        assert summary["commands"] > 50 and "robot" not in summary["processes"], summary
        assert process.poll() is None


# A type of its own on the topic of contacts.
BUMPER = """  button: {node: ros_sensor, topic: /bumper_states, message: std_msgs/Float64, fields: [data]}
  pressed: {node: low_pass}
  presses: {node: ros_command, topic: /bumper_states, message: std_msgs/Float64, fields: {data: 0}}
connections:
  - button -> pressed [1]
  - decoder -> presses [2]
"""


def without_robot(path, **keys):
    """An experiment that leaves the robot to others."""
    file = runs.new_experiment(path, **keys)
    text = file.read_text()
    file.write_text("".join(line for line in text.splitlines(True) if not line.startswith("robot:")))
    return file


def path_of_another_robot(scratch, version):
    """Without `robot:` it is that of /odom: poses that the robot itself has written, and the way between them.
    Without contacts, here because their topic has another type, collisions are not known."""
    file = without_robot(scratch / f"foreign-{version}.yaml", ros=version, duration="4 s")
    file.write_text(file.read_text().replace("\nconnections:\n", f"\n{BUMPER}"))
    own, folder = scratch / f"own-{version}", scratch / f"foreign-{version}"
    with ros.place(version, scratch), ros.program(runs.programs() / "spikeloop-robot", "--ros", version, "--out", own):
        ros.until((own / "world.json").exists, "the robot's start")
        summary, _ = runs.run(file, folder)
    assert summary["processes"]["experiment"]["counters"]["button.messages"] > 10, summary
    poses = {path: [tuple(row[name] for name in ("x_m", "y_m", "theta_rad")) for row in rows(path)]
             for path in (own, folder)}
    known = sum(pose in set(poses[own]) for pose in poses[folder])
    assert known >= 0.95 * len(poses[folder]) > 50, (known, len(poses[folder]))
    points = [(float(x), float(y)) for x, y, _ in poses[folder]]
    way = sum(math.dist(*pair) for pair in itertools.pairwise(points))
    assert way > 0.2 and abs(summary["distance_m"] - way) < 0.001, (way, summary)
    squares = {(round(x / 0.5), round(y / 0.5)) for x, y in points}  # written with fewer digits than they are counted
    assert abs(summary["visited_m2"] - 0.25 * len(squares)) <= 0.25, (len(squares), summary)
    assert all(row["collisions"] == "nan" for row in rows(folder)) and "collisions" not in summary, summary


def collisions_of_another_robot(scratch, version):
    """They are the contacts on /bumper_states that begin, with each thing."""
    file = without_robot(scratch / f"bumper-{version}.yaml", ros=version, duration="600 s")
    file.write_text(file.read_text().replace("sectors [100]", "sectors [10]"))
    folder = scratch / f"bumper-{version}"
    with robots.robot(version, runs.programs(), scratch) as other:
        other.scans(True)
        other.odometry(True)
        with subprocess.Popen([runs.SPIKELOOP, "run", file, "--out", folder]) as process:
            try:
                touch_things(other, folder)
            finally:
                process.send_signal(signal.SIGINT)
        other.scans(False)
        other.odometry(False)
    assert process.returncode == 130, process.returncode
    assert json.loads((folder / "summary.json").read_text())["collisions"] == 5
    counts = [count for count, _ in itertools.groupby(row["collisions"] for row in rows(folder))]
    assert counts == ["nan", "0", "1", "2", "5"], counts


def touch_things(other, folder):
    def newest():
        """Time and collisions of the last row."""
        last = (rows(folder) or [{"t_s": 0, "collisions": ""}])[-1]
        return float(last["t_s"]), last["collisions"]

    def until_counted(collisions):
        ros.until(lambda: newest()[1] == collisions, f"the row with {collisions} collisions")
        return newest()[0]

    ros.until(lambda: (folder / "trajectory.csv").exists(), "a path")
    until_counted("nan")

    def heard_to_be_free():
        other.touch(0)
        return newest()[1] == "0"
    ros.until(heard_to_be_free, "the first message about contacts")
    for things, messages, collisions in ((1, 3, "1"), (1, 1, "2"), (3, 1, "5")):
        for _ in range(messages):
            other.touch(things)
        time_s = until_counted(collisions)
        ros.until(lambda since=time_s: newest()[0] > since + 0.6, "the end of the contact")


def rows(folder):
    return runs.recordings.table(folder / "trajectory.csv")


def killed(scratch):
    """What is killed is named."""
    file = runs.new_experiment(scratch / "long.yaml", ros="1", duration="60 s")
    process = runs.started(file, scratch / "killed", "--stall-timeout", "30", "--start-timeout", "40")
    os.kill(jobs.find(process.pid, "spikeloop-fused"), signal.SIGKILL)
    runs.ended(process, 137, "spikeloop: spikeloop-fused was killed by signal 9 (Killed)")


def stalled(scratch):
    """--stall-timeout means for the processes of an experiment what it means for those of a job."""
    (scratch / "hanging.py").write_text(HANGING)
    file = runs.new_experiment(scratch / "still.yaml", ros="1", duration="60 s")
    text = file.read_text().replace("nodes:\n",
                                    "plugins: [hanging.py]\nnodes:\n  odd: {node: hanging}\n")
    file.write_text(text.replace("scan -> sectors", "scan -> odd [100] -> sectors"))
    for layout in ("fused", "separate"):
        _, printed = runs.run(file, scratch / layout, "--layout", layout, "--stall-timeout", "3", code=3)
        runs.assert_says(printed, "spikeloop: the job has stood still for 3 s")


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        dead_robot(scratch)
        living_robot(scratch)
        living_robot_of_ros2(scratch)
        for version in "12":
            path_of_another_robot(scratch, version)
        killed(scratch)
        stalled(scratch)
        for version in "12":
            collisions_of_another_robot(scratch, version)
    print("a dead robot is replaced, a living one used, a killed process named, one that hangs ended")


if __name__ == "__main__":
    sys.exit(main())
