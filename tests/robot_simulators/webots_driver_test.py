#!/usr/bin/python3
"""The arithmetic of the driver for Webots: wheels and velocities against the kinematics of two wheels."""

import importlib.util
import math
import random
import sys
import unittest
import xml.etree.ElementTree as ElementTree

from folders import SIMULATORS

FOLDER = SIMULATORS / "webots"
sys.dont_write_bytecode = True
spec = importlib.util.spec_from_file_location("vehicle_driver", FOLDER / "vehicle_driver.py")
driver = importlib.util.module_from_spec(spec)
spec.loader.exec_module(driver)


class Driver(unittest.TestCase):
    def test_wheels_move_the_body_as_commanded(self):
        draw = random.Random(1)
        for _ in range(100):
            speed, turn = draw.uniform(-1, 1), draw.uniform(-3, 3)
            left, right = (wheel * driver.WHEEL_RADIUS_M for wheel in driver.wheel_speeds(speed, turn))
            self.assertAlmostEqual((left + right) / 2, speed)
            self.assertAlmostEqual((right - left) / driver.WHEEL_SEPARATION_M, turn)

    def test_commands_are_limited_and_what_is_no_number_stops(self):
        self.assertEqual(driver.wheel_speeds(5, 0), driver.wheel_speeds(1, 0))
        self.assertEqual(driver.wheel_speeds(0, -9), driver.wheel_speeds(0, -3))
        self.assertEqual(driver.wheel_speeds(math.nan, math.inf), (0, 0))

    def test_velocity_of_an_arc(self):
        speed, turn, seconds = 0.4, 1.5, 0.02
        radius = speed / turn
        for heading in (0, 3.13, -2.0):  # also across +-pi
            before = (1.0, 2.0, heading)
            later = heading + turn * seconds
            now = (1.0 + radius * (math.sin(later) - math.sin(heading)),
                   2.0 - radius * (math.cos(later) - math.cos(heading)),
                   math.remainder(later, 2 * math.pi))
            found = driver.body_velocity(before, now, seconds)
            self.assertAlmostEqual(found[0], speed, places=4)  # the chord is shorter than the arc
            self.assertAlmostEqual(found[1], turn)

    def test_the_urdf_names_the_driver_and_the_devices_of_the_world(self):
        webots = ElementTree.parse(FOLDER / "vehicle.urdf").getroot().find("webots")
        module, name = webots.find("plugin").get("type").split(".")
        self.assertTrue((FOLDER / f"{module}.py").is_file())
        self.assertTrue(hasattr(driver, name))
        world = (FOLDER / "arena.wbt").read_text(encoding="utf-8")
        for device in webots.findall("device"):
            self.assertIn(f'name "{device.get("reference")}"', world)


if __name__ == "__main__":
    sys.exit(unittest.main())
