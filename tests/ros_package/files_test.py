#!/usr/bin/python3
"""The package's own files: package.xml, RViz configurations, launch files, its page."""

import ast
import re
import sys
import unittest

import yaml
from catkin_pkg.package import parse_package
from workspace import PACKAGE, SOURCE

LAUNCH = PACKAGE / "launch"


def read(path):
    return path.read_text(encoding="utf-8")


class Files(unittest.TestCase):
    def test_package_xml(self):
        package = parse_package(str(PACKAGE))
        self.assertEqual(package.name, "spikeloop_ros")
        self.assertEqual(package.version, read(SOURCE / "VERSION").strip())
        for version, build_type in (("1", "catkin"), ("2", "ament_cmake")):
            package = parse_package(str(PACKAGE))
            package.evaluate_conditions({"ROS_VERSION": version})
            self.assertEqual(package.get_build_type(), build_type)
            tools = [entry.name for entry in package.buildtool_depends if entry.evaluated_condition]
            self.assertEqual(tools, [build_type])

    def test_each_launch_file_is_there_for_both(self):
        for_ros1 = {path.name for path in LAUNCH.glob("*.launch")}
        for_ros2 = {path.name.removesuffix(".py") for path in LAUNCH.glob("*.launch.py")}
        self.assertEqual(for_ros1, for_ros2)

    def test_launch_files_of_ros2_take_the_arguments_of_ros1(self):
        for path in LAUNCH.glob("*.launch"):
            ros2 = read(LAUNCH / f"{path.name}.py")
            ast.parse(ros2)
            for name in re.findall(r'<arg name="(\w+)"(?! value)', read(path)):
                self.assertIn(f'DeclareLaunchArgument("{name}"', ros2, path)

    def displays(self, version):
        loaded = yaml.safe_load(read(PACKAGE / f"rviz/spikeloop_ros{version}.rviz"))
        manager = loaded["Visualization Manager"]
        self.assertEqual(manager["Global Options"]["Fixed Frame"], "odom")
        return {display["Name"]: display for display in manager["Displays"]}

    def test_rviz_1_and_2_show_the_same(self):
        one, two = self.displays(1), self.displays(2)
        self.assertEqual(list(one), ["Grid", "Frames", "Laser", "Path", "Camera"])
        self.assertEqual(list(one), list(two))
        for name, display in one.items():
            kind = display["Class"].removeprefix("rviz/")
            self.assertEqual(two[name]["Class"], f"rviz_default_plugins/{kind}")
            topic = display.get("Topic", display.get("Image Topic"))
            self.assertEqual(topic, two[name].get("Topic", {}).get("Value"))

    def test_the_page_names_launch_files_that_are_there(self):
        named = re.findall(r"(?:roslaunch|ros2 launch) (?:spikeloop_ros )?(\S+?\.launch(?:\.py)?)",
                           read(PACKAGE / "README.md"))
        self.assertGreaterEqual(len(named), 6)
        for name in named:
            self.assertTrue((LAUNCH / name.split("/")[-1]).is_file(), name)


if __name__ == "__main__":
    sys.exit(unittest.main())
