"""Workspaces of catkin and colcon with the package spikeloop_ros in them."""

import os
import pathlib
import subprocess

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = SOURCE / "ros"
PROGRAMS = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])
ALSO_SET = ("ROS_", "CMAKE_PREFIX_PATH", "AMENT_", "COLCON_", "PYTHONPATH", "PKG_CONFIG_PATH")


def bare(**more):
    """This process' variables without those of any ROS, and with our programs in PATH."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(ALSO_SET)}
    return {**kept, "PATH": f"{PROGRAMS}:/usr/sbin:/usr/bin:/sbin:/bin", **more}


def make(folder, *command, ros_version):
    """A workspace in `folder` in which `command` has built the package. Returns its install/."""
    (folder / "src").mkdir(parents=True)
    (folder / "src/spikeloop_ros").symlink_to(PACKAGE)
    shell = bare(ROS_VERSION=str(ros_version), HOME=str(folder), PWD=str(folder))  # catkin_make asks PWD
    done = subprocess.run(command, cwd=folder, env=shell, capture_output=True, text=True, timeout=200,
                          check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "install"


def catkin(folder):
    return make(folder, "catkin_make", "install", ros_version=1)


def colcon(folder):
    return make(folder, "colcon", "build", ros_version=2)


def sourced(setup, **more):
    """The variables of a shell that has sourced `setup`."""
    told = subprocess.run(["/bin/bash", "-c", f"source '{setup}' >/dev/null && env --null"], env=bare(**more),
                          capture_output=True, text=True, timeout=60, check=True).stdout
    return dict(entry.split("=", 1) for entry in told.rstrip("\0").split("\0"))
