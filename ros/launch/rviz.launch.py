"""RViz with laser, path, camera and frames:  ros2 launch spikeloop_ros rviz.launch.py"""
import pathlib

from launch import LaunchDescription
from launch.actions import ExecuteProcess

CONFIGURATION = pathlib.Path(__file__).resolve().parents[1] / "rviz" / "spikeloop_ros2.rviz"


def generate_launch_description():
    return LaunchDescription([ExecuteProcess(cmd=["rviz2", "-d", str(CONFIGURATION)])])
