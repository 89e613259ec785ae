#!/usr/bin/python3
"""The robot in rclpy of docs/stepping.md against a recurrence by hand, over every middleware of ROS 2 that is installed.
Where /usr/bin/python3 has no rclpy the test is skipped: `. SETUP.bash` of a workspace gives it."""

import importlib.util
import os
import pathlib
import sys
import tempfile

import ros
import runs
import stepping_test

SKIPPED = 77
MIDDLEWARES = ("rmw_cyclonedds_cpp", "rmw_fastrtps_cpp")


def main():
    if importlib.util.find_spec("rclpy") is None:
        print("there is no rclpy here")
        return SKIPPED
    spikeloop = str(runs.programs() / "spikeloop")
    for middleware in MIDDLEWARES:
        os.environ["RMW_IMPLEMENTATION"] = middleware
        with tempfile.TemporaryDirectory() as scratch, ros.domain():
            scratch = pathlib.Path(scratch)
            file = scratch / "cart.yaml"
            file.write_text(stepping_test.EXPERIMENT)
            with stepping_test.cart(scratch, text=stepping_test.IN_RCLPY):
                summary = stepping_test.follows_the_recurrence(spikeloop, file, scratch / "run", "--ros", "2")
        print(f"{middleware}: to the bit, at {1000 * summary['real_time_factor']:.0f} ticks/s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
