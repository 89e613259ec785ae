"""Gazebo with the arena, and its topics in ROS 2.

    ros2 launch ./gz_sim.launch.py [gui:=false] [rviz:=true]
"""
import pathlib

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.conditions import IfCondition
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution, PythonExpression
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

HERE = pathlib.Path(__file__).resolve().parent
RVIZ = HERE.parents[2] / "ros" / "rviz" / "spikeloop_ros2.rviz"


def generate_launch_description():
    # Without a window the laser still needs a GPU, or Mesa's software renderer, through EGL.
    window = PythonExpression(
        ["'' if '", LaunchConfiguration("gui"), "' == 'true' else '-s --headless-rendering'"])
    return LaunchDescription([
        DeclareLaunchArgument("gui", default_value="true", description="false: no window"),
        DeclareLaunchArgument("rviz", default_value="false", description="true: RViz beside it"),
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(PathJoinSubstitution(
                [FindPackageShare("ros_gz_sim"), "launch", "gz_sim.launch.py"])),
            launch_arguments={"gz_args": ["-r ", window, " ", str(HERE / "arena.sdf")],
                              "on_exit_shutdown": "true"}.items()),
        Node(package="ros_gz_bridge", executable="parameter_bridge", output="screen",
             parameters=[{"config_file": str(HERE / "bridge.yaml")}]),
        Node(package="tf2_ros", executable="static_transform_publisher",
             arguments=["--x", "0.10", "--z", "0.12",
                        "--frame-id", "base_link", "--child-frame-id", "laser"]),
        Node(package="rviz2", executable="rviz2", arguments=["-d", str(RVIZ)],
             parameters=[{"use_sim_time": True}], condition=IfCondition(LaunchConfiguration("rviz"))),
    ])
