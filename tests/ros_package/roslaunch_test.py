#!/usr/bin/python3
"""roslaunch starts robot and experiment from a catkin workspace, and ends them as they should be ended."""

import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import xmlrpc.client

import workspace

sys.path += [str(workspace.SOURCE / "tests" / folder) for folder in ("fused", "support")]
import growing_file  # noqa: E402
import ros  # noqa: E402

EXPERIMENT = """experiment: turning
duration: {duration}
sync: realtime
ros: 1
{robot}
nodes:
  scan: {{node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}}
  speeds: {{node: connect, weights: uniform}}
  wheels: {{node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist,
           fields: {{linear.x: {{channel: 0, scale: 0, offset: 0.3}}}}}}
connections:
  - scan -> speeds [100] -> wheels [1]
"""
DEADLINE_S = 60  # of what waits; nothing is timed by it


def wait_for(condition):
    end = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < end, "it takes too long"
        time.sleep(0.05)


class Roslaunch(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)
        prefix = workspace.catkin(cls.folder / "workspace")
        cls.shell = workspace.sourced(prefix / "setup.bash", HOME=str(cls.folder))
        with xmlrpc.client.ServerProxy(cls.enterClassContext(ros.master(cls.folder, "roscore"))) as master:
            # roscore names its run after it answers; a roslaunch in between would take it for another's.
            wait_for(lambda: master.hasParam("/test", "/run_id")[2])
        cls.shell.update({name: value for name, value in os.environ.items() if name.startswith("ROS_M")
                          or name in ("ROS_HOSTNAME", "ROS_LOG_DIR")})

    def experiment(self, name, duration, robot=""):
        path = self.folder / f"{name}.yaml"
        path.write_text(EXPERIMENT.format(duration=duration, robot=robot), encoding="utf-8")
        return path

    def launch(self, *words):
        """A roslaunch that is ended with the test, and the file of what it says."""
        said = self.folder / f"{self.id()}-{words[1]}.txt"
        with said.open("w") as output:
            process = subprocess.Popen(["roslaunch", *words], cwd=self.folder, env=self.shell,
                                       stdout=output, stderr=subprocess.STDOUT)

        def end():
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
            process.wait(DEADLINE_S)

        self.addCleanup(end)
        return process, said

    def summary(self, run):
        return json.loads((run / "summary.json").read_text(encoding="utf-8"))

    def test_an_experiment_runs_to_its_end_and_ends_the_launch(self):
        file = self.experiment("whole", "1 s", "robot: {simulator: mujoco}")
        run = self.folder / "whole"
        process, said = self.launch("spikeloop_ros", "experiment.launch", f"file:={file}",
                                    f"arguments:=--out {run} --seed 3")
        self.assertEqual(process.wait(DEADLINE_S), 0, said.read_text(encoding="utf-8"))
        self.assertIn("finished: 1.0 of 1 s", said.read_text(encoding="utf-8"))
        self.assertEqual(json.loads((run / "resolved.json").read_text(encoding="utf-8"))["seed"], 3)

    def test_robot_and_experiment_meet_and_ctrl_c_stops_the_robot(self):
        drive = self.folder / "drive"
        robot, told = self.launch("spikeloop_ros", "robot.launch", f"arguments:=--out {drive}")
        file = self.experiment("stopped", "10 min")
        process, said = self.launch("spikeloop_ros", "experiment.launch", f"file:={file}",
                                    f"arguments:=--out {self.folder / 'stopped'}")

        def path():
            return growing_file.table(drive / "trajectory.csv")

        wait_for(lambda: any(float(row["v_m_s"]) > 0.2 for row in path()))
        process.send_signal(signal.SIGINT)
        process.wait(DEADLINE_S)
        self.assertNotIn("escalating", said.read_text(encoding="utf-8"))  # roslaunch had to use SIGTERM
        stopped_at = float(path()[-1]["t_s"])
        wait_for(lambda: float(path()[-1]["t_s"]) > stopped_at + 1)
        robot.send_signal(signal.SIGINT)
        robot.wait(DEADLINE_S)
        self.assertNotIn("escalating", told.read_text(encoding="utf-8"))
        self.assertLess(abs(float(path()[-1]["v_m_s"])), 0.01)

    def test_an_experiment_gets_its_remaps(self):
        spikeloop = self.folder / "bin/spikeloop"
        spikeloop.parent.mkdir()
        spikeloop.write_text('#!/bin/sh\necho "$@"\n', encoding="utf-8")
        spikeloop.chmod(0o755)
        done = subprocess.run([workspace.PACKAGE / "scripts/run_experiment", "loop.yaml", "__name:=experiment",
                               "/scan:=/front/scan", "__log:=/tmp/log"], capture_output=True, text=True, check=False,
                              env={"PATH": f"{spikeloop.parent}:/bin"})
        self.assertEqual(done.stdout, "run loop.yaml /scan:=/front/scan\n")

    def test_programs_that_are_not_in_path_are_named(self):
        for script, program in (("run_experiment", "spikeloop"), ("robot", "spikeloop-robot")):
            done = subprocess.run([workspace.PACKAGE / f"scripts/{script}"], env={"PATH": "/bin"},
                                  capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 3)
            self.assertEqual(done.stderr, f"{script}: there is no program '{program}' in PATH; write for "
                             "example  export PATH=$HOME/spikeloop/build/release/bin:$PATH\n")


if __name__ == "__main__":
    sys.exit(unittest.main())
