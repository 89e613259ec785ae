"""An experiment with  ros: 2.  The launch ends with it.

    ros2 launch spikeloop_ros experiment.launch.py file:=explorer.yaml [arguments:="--sync sim_time"] [rviz:=true]
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


def experiment(context):
    words = shlex.split(LaunchConfiguration("arguments").perform(context))
    file = LaunchConfiguration("file").perform(context)
    return [ExecuteProcess(cmd=["spikeloop", "run", file, *words], output="screen",
                           on_exit=Shutdown(reason="the experiment is over"))]


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("file", description="Experiment file"),
        DeclareLaunchArgument("arguments", default_value="", description="More for  spikeloop run"),
        DeclareLaunchArgument("rviz", default_value="false", description="true: RViz beside it"),
        OpaqueFunction(function=experiment),
        IncludeLaunchDescription(PythonLaunchDescriptionSource(str(HERE / "rviz.launch.py")),
                                 condition=IfCondition(LaunchConfiguration("rviz"))),
    ])
