"""The simulated vehicle as a node of ROS 2.

    ros2 launch spikeloop_ros robot.launch.py [arguments:="--seed 3"] [rviz:=true]
"""
import pathlib
import shlex

from launch import LaunchDescription
from launch.actions import (DeclareLaunchArgument, ExecuteProcess, IncludeLaunchDescription,
                            OpaqueFunction, Shutdown)
from launch.conditions import IfCondition
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration

HERE = pathlib.Path(__file__).resolve().parent


def robot(context):
    words = shlex.split(LaunchConfiguration("arguments").perform(context))
    return [ExecuteProcess(cmd=["spikeloop-robot", "--ros", "2", *words], output="screen",
                           on_exit=Shutdown(reason="the robot has ended"))]


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("arguments", default_value="", description="More for  spikeloop-robot"),
        DeclareLaunchArgument("rviz", default_value="false", description="true: RViz beside it"),
        OpaqueFunction(function=robot),
        IncludeLaunchDescription(PythonLaunchDescriptionSource(str(HERE / "rviz.launch.py")),
                                 condition=IfCondition(LaunchConfiguration("rviz"))),
    ])
