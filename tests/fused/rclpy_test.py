#!/usr/bin/python3
"""The robots in rclpy and rclcpp of docs/stepping.md against a recurrence by hand, over every middleware of ROS 2 that is
installed, and over both of our transports: Cyclone DDS and rclcpp. Where /usr/bin/python3 has no rclpy the test is
skipped: `. SETUP.bash` of a workspace gives it."""

import contextlib
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile

import ros
import stepping_test

SKIPPED = 77
TRANSPORTS = ("cyclonedds", "rclcpp")
MIDDLEWARES = ("rmw_cyclonedds_cpp", "rmw_fastrtps_cpp")
PACKAGE = pathlib.Path(__file__).parents[2] / "ros"
CART = """cmake_minimum_required(VERSION 3.10)
project(cart CXX C)
find_package(rclcpp REQUIRED)
find_package(std_msgs REQUIRED)
find_package(nlohmann_json REQUIRED)
add_executable(cart cart.cpp)
target_link_libraries(cart rclcpp::rclcpp ${std_msgs_TARGETS} nlohmann_json::nlohmann_json)
install(TARGETS cart DESTINATION bin)
"""


def build(workspace):
    """The ROS package with the transport, whose library programs find, and the page's cart. @return the cart's program"""
    cart = workspace / "src/cart"
    cart.mkdir(parents=True)
    (cart / "CMakeLists.txt").write_text(CART)
    (cart / "cart.cpp").write_text(stepping_test.IN_RCLCPP)
    (workspace / "src/spikeloop_ros").symlink_to(PACKAGE)
    subprocess.run(["colcon", "build"], cwd=workspace, env={**os.environ, "ROS_VERSION": "2"}, check=True)
    os.environ["LD_LIBRARY_PATH"] += f":{workspace}/install/spikeloop_ros/lib"
    return workspace / "install/cart/bin/cart"


def drive(start_cart):
    """@return ticks a second"""
    with tempfile.TemporaryDirectory() as scratch, ros.domain():
        scratch = pathlib.Path(scratch)
        file = scratch / "cart.yaml"
        file.write_text(stepping_test.EXPERIMENT)
        with start_cart(scratch):
            summary = stepping_test.follows_the_recurrence(file, scratch / "run", "--ros", "2")
    return 1000 * summary["real_time_factor"]


def main():
    if importlib.util.find_spec("rclpy") is None:
        print("there is no rclpy here")
        return SKIPPED
    with contextlib.ExitStack() as stack:
        program = build(pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory())))
        carts = {"rclpy": lambda scratch: stepping_test.cart(scratch, text=stepping_test.IN_RCLPY),
                 "rclcpp": lambda _: ros.program(program)}
        for transport in TRANSPORTS:
            for middleware in MIDDLEWARES:
                os.environ.update(SPIKELOOP_ROS2=transport, RMW_IMPLEMENTATION=middleware)
                for library, start_cart in carts.items():
                    print(f"{transport} of ours, {middleware} and {library} of the robot: bit-identical, "
                          f"{drive(start_cart):.0f} ticks/s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
