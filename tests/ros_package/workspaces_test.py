#!/usr/bin/python3
"""catkin (ROS 1) and colcon (ROS 2) build the package, and its files are where both look for them."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import workspace

LAUNCH = {path.name for path in (workspace.PACKAGE / "launch").iterdir()}
RVIZ = {path.name for path in (workspace.PACKAGE / "rviz").iterdir()}
SCRIPTS = {path.name for path in (workspace.PACKAGE / "scripts").iterdir()}
OF_ROS2 = {"step_simulator"}


def names(folder):
    return {path.name for path in folder.iterdir()}


class Workspaces(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def check_files(self, prefix, scripts):
        share = prefix / "share/spikeloop_ros"
        self.assertTrue((share / "package.xml").is_file())
        self.assertEqual(names(share / "launch"), LAUNCH)
        self.assertEqual(names(share / "rviz"), RVIZ)
        programs = prefix / "lib/spikeloop_ros"
        self.assertEqual(names(programs), scripts)
        for name in scripts:
            self.assertTrue(os.access(programs / name, os.X_OK), name)

    def test_catkin(self):
        prefix = workspace.catkin(self.folder)
        self.check_files(prefix, SCRIPTS - OF_ROS2)
        for setup, share, program in (
                (prefix / "setup.bash", prefix / "share/spikeloop_ros", prefix / "lib/spikeloop_ros/robot"),
                (self.folder / "devel/setup.bash", self.folder / "src/spikeloop_ros",
                 workspace.PACKAGE / "scripts/robot")):
            shell = workspace.sourced(setup, HOME=str(self.folder))

            def roslaunch(*words):
                done = subprocess.run(["roslaunch", *words], env=shell, capture_output=True, text=True,
                                      timeout=60, check=False)
                self.assertEqual(done.returncode, 0, done.stderr)
                return done.stdout.split()

            files = roslaunch("--files", "spikeloop_ros", "robot.launch", "rviz:=true")
            self.assertEqual(sorted(files), [f"{share}/launch/{name}.launch" for name in ("robot", "rviz")])
            command = roslaunch("--args", "spikeloop_robot", "spikeloop_ros", "robot.launch")
            self.assertEqual(pathlib.Path(command[0]).resolve(), program.resolve())

    def test_colcon(self):
        install = workspace.colcon(self.folder)
        prefix = install / "spikeloop_ros"
        self.check_files(prefix, SCRIPTS)
        self.assertTrue((prefix / "share/ament_index/resource_index/packages/spikeloop_ros").is_file())
        shell = workspace.sourced(install / "setup.bash", HOME=str(self.folder))
        self.assertIn(str(prefix), shell["AMENT_PREFIX_PATH"].split(":"))

    def test_without_a_ros_the_build_says_what_to_source(self):
        done = subprocess.run(["cmake", "-S", workspace.PACKAGE, "-B", self.folder], env=workspace.bare(),
                              capture_output=True, text=True, timeout=60, check=False)
        self.assertNotEqual(done.returncode, 0)
        said = " ".join(done.stderr.split())
        self.assertIn("ROS_VERSION is ''; source the setup.bash of a ROS first, or write export ROS_VERSION=1 "
                      "(2 for ROS 2)", said)


if __name__ == "__main__":
    sys.exit(unittest.main())
