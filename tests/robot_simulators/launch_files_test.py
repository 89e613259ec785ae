#!/usr/bin/python3
"""Launch files: roslaunch reads those of ROS 1; those of ROS 2 compile and name files that exist.

Gazebo's own package is not in Debian. So an empty package of its name stands beside: it shows that roslaunch
resolves every name and argument of ours, not that Gazebo starts.
"""

import ast
import os
import pathlib
import re
import sys
import tempfile
import unittest

import roslaunch.config
import yaml
from folders import FOLDERS, SIMULATORS

EMPTY_WORLD = """<launch>
  <arg name="world_name"/>
  <arg name="gui"/>
  <param name="world" value="$(arg world_name)"/>
  <param name="gui" value="$(arg gui)"/>
</launch>
"""


def package(folder, name):
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(
        f"<package><name>{name}</name><version>1.0.0</version><description>-</description>"
        "<maintainer email='a@b.org'>-</maintainer><license>-</license></package>", encoding="utf-8")


class Ros1(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        gazebo = pathlib.Path(scratch.name) / "gazebo_ros"
        package(gazebo, "gazebo_ros")
        (gazebo / "launch").mkdir()
        (gazebo / "launch/empty_world.launch").write_text(EMPTY_WORLD, encoding="utf-8")
        os.environ["ROS_PACKAGE_PATH"] = scratch.name

    def load(self, *arguments):
        file = str(SIMULATORS / "gazebo_classic/gazebo_ros1.launch")
        return roslaunch.config.load_config_default([(file, list(arguments))], 11311)

    def test_world_vehicle_and_laser(self):
        config = self.load()
        world = pathlib.Path(config.params["/world"].value)
        self.assertEqual(world.resolve(), SIMULATORS / "gazebo_classic/arena.world")
        nodes = {node.name: node for node in config.nodes}
        self.assertEqual(set(nodes), {"spawn_vehicle", "laser_place"})
        words = nodes["spawn_vehicle"].args.split()
        self.assertTrue(pathlib.Path(words[words.index("-file") + 1]).is_file())

    def test_arguments_reach_what_they_are_for(self):
        config = self.load("gui:=false", "rviz:=true")
        self.assertEqual(config.params["/gui"].value, False)
        rviz = next(node for node in config.nodes if node.name == "rviz")
        self.assertTrue(pathlib.Path(rviz.args.split()[1]).is_file())


class Ros2(unittest.TestCase):
    def test_they_compile_and_name_files_that_exist(self):
        files = [path for folder in FOLDERS for path in folder.glob("*.launch.py")]
        self.assertEqual(len(files), 3)
        for path in files:
            text = path.read_text(encoding="utf-8")
            functions = [node.name for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef)]
            self.assertEqual(functions, ["generate_launch_description"])
            named = re.findall(r'HERE / "([^"]+)"', text)
            self.assertGreaterEqual(len(named), 2)
            for name in named:
                self.assertTrue((path.parent / name).is_file(), name)
            up, *words = re.search(r'RVIZ = HERE\.parents\[(\d)\]((?: / "[^"]+")+)', text).groups()
            rviz = path.parent.parents[int(up)].joinpath(*re.findall(r'"([^"]+)"', words[0]))
            self.assertTrue(rviz.is_file(), rviz)

    def test_the_bridge_carries_what_the_world_sends_and_takes(self):
        bridge = yaml.safe_load((SIMULATORS / "gz_sim/bridge.yaml").read_text(encoding="utf-8"))
        world = (SIMULATORS / "gz_sim/arena.sdf").read_text(encoding="utf-8")
        carried = {entry["topic_name"]: entry["direction"] for entry in bridge}
        told = set(re.findall(r"<(?:odom_|tf_)?topic>(/[a-z_]+)</", world))
        self.assertEqual(set(carried), told | {"/clock"})  # which Gazebo has anyway
        self.assertEqual([topic for topic, way in carried.items() if way == "ROS_TO_GZ"], ["/cmd_vel"])
        for entry in bridge:
            self.assertEqual(set(entry), {"topic_name", "ros_type_name", "gz_type_name", "direction"})


if __name__ == "__main__":
    sys.exit(unittest.main())
