"""Webots with the arena, and its topics in ROS 2.

    ros2 launch ./webots.launch.py [gui:=false] [mode:=fast] [rviz:=true]
"""
import pathlib

from launch import LaunchDescription
from launch.actions import (DeclareLaunchArgument, EmitEvent, RegisterEventHandler,
                            SetEnvironmentVariable)
from launch.conditions import IfCondition
from launch.event_handlers import OnProcessExit
from launch.events import Shutdown
from launch.substitutions import EnvironmentVariable, LaunchConfiguration
from launch_ros.actions import Node
from webots_ros2_driver.webots_controller import WebotsController
from webots_ros2_driver.webots_launcher import WebotsLauncher

HERE = pathlib.Path(__file__).resolve().parent
RVIZ = HERE.parents[2] / "ros" / "rviz" / "spikeloop_ros2.rviz"


def generate_launch_description():
    webots = WebotsLauncher(world=str(HERE / "arena.wbt"), mode=LaunchConfiguration("mode"),
                            gui=LaunchConfiguration("gui"), ros2_supervisor=True)  # /clock is its work
    return LaunchDescription([
        DeclareLaunchArgument("gui", default_value="true", description="false: no window"),
        DeclareLaunchArgument("mode", default_value="realtime", description="realtime or fast"),
        DeclareLaunchArgument("rviz", default_value="false", description="true: RViz beside it"),
        # Where the plug-in vehicle_driver.py lies.
        SetEnvironmentVariable("PYTHONPATH", [
            str(HERE), ":", EnvironmentVariable("PYTHONPATH", default_value="")]),
        webots,
        webots._supervisor,
        WebotsController(robot_name="vehicle",
                         parameters=[{"robot_description": str(HERE / "vehicle.urdf"),
                                      "use_sim_time": True}]),
        # Upside down, see arena.wbt.
        Node(package="tf2_ros", executable="static_transform_publisher",
             arguments=["--x", "0.10", "--z", "0.12", "--roll", "3.1415927",
                        "--frame-id", "base_link", "--child-frame-id", "laser"]),
        Node(package="rviz2", executable="rviz2", arguments=["-d", str(RVIZ)],
             parameters=[{"use_sim_time": True}], condition=IfCondition(LaunchConfiguration("rviz"))),
        RegisterEventHandler(OnProcessExit(
            target_action=webots, on_exit=[EmitEvent(event=Shutdown())])),
    ])
