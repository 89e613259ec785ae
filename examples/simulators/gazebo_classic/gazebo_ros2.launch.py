"""Gazebo 11 with the arena and the vehicle, for ROS 2.

    ros2 launch ./gazebo_ros2.launch.py [gui:=false] [rviz:=true]
"""
import pathlib

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.conditions import IfCondition
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

HERE = pathlib.Path(__file__).resolve().parent
RVIZ = HERE.parents[2] / "ros" / "rviz" / "spikeloop_ros2.rviz"
START = {"-x": "-0.8915", "-y": "-0.31", "-z": "0.08", "-Y": "-1.7147"}  # of seed 1


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("gui", default_value="true", description="false: no window"),
        DeclareLaunchArgument("rviz", default_value="false", description="true: RViz beside it"),
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(PathJoinSubstitution(
                [FindPackageShare("gazebo_ros"), "launch", "gazebo.launch.py"])),
            launch_arguments={"world": str(HERE / "arena.world"),
                              "params_file": str(HERE / "clock.yaml"),
                              "gui": LaunchConfiguration("gui")}.items()),
        Node(package="gazebo_ros", executable="spawn_entity.py", output="screen",
             arguments=["-entity", "vehicle", "-file", str(HERE / "vehicle_ros2.sdf"),
                        *(word for pair in START.items() for word in pair)]),
        Node(package="tf2_ros", executable="static_transform_publisher",
             arguments=["--x", "0.10", "--z", "0.12",
                        "--frame-id", "base_link", "--child-frame-id", "laser"]),
        Node(package="rviz2", executable="rviz2", arguments=["-d", str(RVIZ)],
             parameters=[{"use_sim_time": True}], condition=IfCondition(LaunchConfiguration("rviz"))),
    ])
