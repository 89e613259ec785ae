#!/usr/bin/python3
"""Worlds of other simulators are the shipped arena with the shipped vehicle's measures."""

import json
import math
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

import wbt
from folders import SIMULATORS, SOURCE, spikeloop

WORLDS = SOURCE / "robots/vehicle/worlds"
GZ_SIM = SIMULATORS / "gz_sim/arena.sdf"
GAZEBO = SIMULATORS / "gazebo_classic/arena.world"
VEHICLES = [SIMULATORS / f"gazebo_classic/vehicle_ros{version}.sdf" for version in (1, 2)]
WEBOTS = SIMULATORS / "webots/arena.wbt"


def numbers(text):
    return [float(word) for word in text.split()]


class Shipped:
    """What the shipped vehicle finds in the shipped arena of seed 1."""

    def __init__(self):
        with tempfile.TemporaryDirectory() as folder:
            code, said = spikeloop("run", "../01_braitenberg/braitenberg.yaml", "--duration", "10ms",
                                   "--no-record", "--out", f"{folder}/run")
            assert code == 0, said
            with open(f"{folder}/run/world.json", encoding="utf-8") as file:
                self.world = json.load(file)
        model = ElementTree.parse(WORLDS / "spikeloop_vehicle.xml").getroot()

        def one(path, key):
            return numbers(model.find(path).get(key))

        self.centre_z = one(".//body[@name='vehicle']", "pos")[2]
        self.chassis = one(".//geom[@name='chassis']", "size"), one(".//geom[@name='chassis']", "pos")
        self.laser_place = one(".//site[@name='laser']", "pos")
        self.wheel_y = one(".//body[@name='wheel_front_left']", "pos")[1]
        wheel = one(".//default[@class='wheel']/geom", "size")
        self.wheel_radius, self.wheel_width = wheel[0], 2 * wheel[1]
        self.limits = one(".//numeric[@name='command_limits']", "data")
        self.laser = one(".//numeric[@name='laser']", "data")
        self.step_s = float(model.find("option").get("timestep"))

    def obstacles(self):
        """name: (x, y, heading, shape), shape (full x, full y) or (radius,)."""
        found = {}
        for obstacle in self.world["obstacles"]:
            box = obstacle["shape"] == "box"
            shape = (2 * obstacle["half_x_m"], 2 * obstacle["half_y_m"]) if box else (obstacle["radius_m"],)
            heading = obstacle["theta_rad"] if box else 0
            found[obstacle["name"]] = (obstacle["x_m"], obstacle["y_m"], heading, shape)
        return found


def sdf_things(path):
    """name: (x, y, heading, shape) of all boxes and cylinders that stand on the floor."""
    found = {}
    for model in ElementTree.parse(path).getroot().iter("model"):
        if model.get("name") in ("floor", "vehicle"):
            continue
        assert model.find("static").text == "true", model.get("name")
        x, y, z, roll, pitch, heading = numbers(model.find("pose").text)
        assert (z, roll, pitch) == (0.25, 0, 0), model.get("name")
        shapes = []
        for part in ("collision", "visual"):
            box = model.find(f"link/{part}/geometry/box/size")
            cylinder = model.find(f"link/{part}/geometry/cylinder")
            if box is not None:
                *sides, height = numbers(box.text)
            else:
                sides, height = [float(cylinder.find("radius").text)], float(cylinder.find("length").text)
            assert height == 0.5, model.get("name")
            shapes.append(tuple(sides))
        assert shapes[0] == shapes[1], f"{model.get('name')} looks different from what it is"
        found[model.get("name")] = (x, y, heading, shapes[0])
    return found


def webots_things(nodes):
    found = {}
    for node in nodes:
        if node["node"] != "Solid" or node["name"] == "floor":
            continue
        x, y, z = node["translation"]
        bounds, seen = node["boundingObject"], node["children"][0]["geometry"]
        assert bounds == seen, f"{node['name']} looks different from what it is"
        box = bounds["node"] == "Box"
        *sides, height = bounds["size"] if box else (bounds["radius"], bounds["height"])
        assert (z, height) == (0.25, 0.5) and node["rotation"][:3] == [0, 0, 1], node["name"]
        found[node["name"]] = (x, y, node["rotation"][3], tuple(sides))
    return found


def without(element, *tags):
    """The element as text, without children of these tags, comments and white space."""
    for parent in list(element.iter()):
        for child in list(parent):
            if child.tag in tags:
                parent.remove(child)
    return re.sub(r"\s+", "", ElementTree.tostring(element, encoding="unicode"))


class Worlds(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.shipped = Shipped()
        cls.webots = wbt.read(WEBOTS.read_text(encoding="utf-8"))

    def near(self, found, expected, tolerance=1e-4):
        for value, wanted in zip(found, expected, strict=True):
            self.assertAlmostEqual(value, wanted, delta=tolerance)

    def test_libsdformat_finds_nothing_wrong(self):
        for path in (GZ_SIM, GAZEBO, *VEHICLES):
            done = subprocess.run(["ign", "sdf", "--check", path], capture_output=True, text=True,
                                  check=False)
            said = [line for line in (done.stdout + done.stderr).splitlines() if "Library error" not in line]
            self.assertEqual(said, ["Valid."], path)

    def test_walls_and_obstacles_stand_where_seed_1_puts_them(self):
        arena = self.shipped.world["arena"]
        for things in (sdf_things(GZ_SIM), sdf_things(GAZEBO), webots_things(self.webots)):
            walls = {name: things.pop(name) for name in list(things) if name.startswith("wall_")}
            inner = {"wall_east": arena["max_x_m"], "wall_west": arena["min_x_m"],
                     "wall_north": arena["max_y_m"], "wall_south": arena["min_y_m"]}
            self.assertEqual(walls.keys(), inner.keys())
            for name, (x, y, heading, sides) in walls.items():
                along, across = (0, 1) if name in ("wall_east", "wall_west") else (1, 0)
                place = (x, y)[along]
                self.assertAlmostEqual(place - math.copysign(sides[along] / 2, place), inner[name])
                self.assertGreater(sides[across], 6)
                self.assertEqual(((x, y)[across], heading), (0, 0))
            self.assertEqual(things.keys(), self.shipped.obstacles().keys())
            for name, (x, y, heading, shape) in self.shipped.obstacles().items():
                with self.subTest(name):
                    self.near(things[name][:3], (x, y, heading))
                    self.near(things[name][3], shape)

    def start(self):
        start = self.shipped.world["start"]
        return start["x_m"], start["y_m"], self.shipped.centre_z, start["theta_rad"]

    def test_the_vehicle_starts_where_seed_1_puts_it(self):
        x, y, z, heading = self.start()
        pose = numbers(ElementTree.parse(GZ_SIM).find(".//model[@name='vehicle']/pose").text)
        self.near(pose, (x, y, z, 0, 0, heading))
        robot = next(node for node in self.webots if node["node"] == "Robot")
        self.near(robot["translation"], (x, y, z))
        self.near(robot["rotation"], (0, 0, 1, heading))
        for name in ("gazebo_ros1.launch", "gazebo_ros2.launch.py"):
            text = (SIMULATORS / "gazebo_classic" / name).read_text(encoding="utf-8")
            given = re.findall(r'-([xyzY])(?:": "| )(-?[0-9.]+)', text)
            self.assertEqual([letter for letter, _ in given], ["x", "y", "z", "Y"], name)
            self.near([float(value) for _, value in given], self.start())

    def vehicles(self):
        yield ElementTree.parse(GZ_SIM).find(".//model[@name='vehicle']")
        for path in VEHICLES:
            yield ElementTree.parse(path).find("model")

    def test_gazebos_vehicles_differ_in_sensor_and_plugins_alone(self):
        texts = []
        for vehicle in self.vehicles():
            for pose in vehicle.findall("pose"):
                vehicle.remove(pose)  # of the model in its world
            texts.append(without(vehicle, "plugin", "sensor"))
        self.assertEqual(len(set(texts)), 1)

    def test_gazebos_vehicles_have_the_measures_of_the_shipped_one(self):
        half, place = self.shipped.chassis
        for vehicle in self.vehicles():
            chassis = vehicle.find(".//collision[@name='chassis']")
            self.near(numbers(chassis.find("geometry/box/size").text), [2 * side for side in half])
            self.near(numbers(chassis.find("pose").text)[:3], place)
            for name, y in (("left", self.shipped.wheel_y), ("right", -self.shipped.wheel_y)):
                wheel = vehicle.find(f"link[@name='wheel_{name}']")
                self.near(numbers(wheel.find("pose").text), (0, y, 0, -math.pi / 2, 0, 0))
                def measures(part):
                    return [float(wheel.find(f"{part}/geometry/cylinder/{tag}").text)
                            for tag in ("radius", "length")]
                self.near(measures("visual"), (self.shipped.wheel_radius, self.shipped.wheel_width))
                radius, width = measures("collision[@name='tread']")
                self.near([radius], [self.shipped.wheel_radius])
                self.assertLess(width, self.shipped.wheel_width / 5)
                radius, width = measures("collision[@name='side']")
                self.near([width], [self.shipped.wheel_width])
                self.assertLess(radius, self.shipped.wheel_radius)
            drive = {entry.tag.replace("_", "").lower(): entry.text for entry in vehicle.find("plugin")}
            self.assertEqual(float(drive["wheelseparation"]), 2 * self.shipped.wheel_y)
            radius = float(drive.get("wheelradius", 0)) or float(drive["wheeldiameter"]) / 2
            self.assertEqual(radius, self.shipped.wheel_radius)
            joints = {joint.get("name") for joint in vehicle.iter("joint")}
            self.assertEqual({drive["leftjoint"], drive["rightjoint"]}, joints)
            acceleration = self.shipped.limits[2]
            self.assertFalse({"maxwheelacceleration", "wheelacceleration"} & set(drive))
            torque = float(drive.get("maxwheeltorque", drive.get("wheeltorque", 0)))
            if torque:  # of two wheels, for the vehicle's 12 kg
                self.assertLess(abs(2 * torque / radius / 12 - acceleration), 0.3)
            else:
                limits = [drive[f"max{kind}"] for kind in ("linearvelocity", "angularvelocity",
                                                           "linearacceleration", "angularacceleration")]
                self.assertEqual([float(limit) for limit in limits], self.shipped.limits)

    def test_gazebos_bumpers_are_of_what_does_not_touch_the_floor(self):
        for path in VEHICLES:
            vehicle = ElementTree.parse(path).find("model")
            bumper = vehicle.find("link[@name='base_link']/sensor[@type='contact']")
            self.assertEqual([part.text for part in bumper.iter("collision")], ["chassis"])
            self.assertEqual(bumper.find("plugin").get("filename"), "libgazebo_ros_bumper.so")

    def test_gazebos_lasers_are_the_shipped_one(self):
        beams, first, last, nearest, farthest, rate = self.shipped.laser
        for vehicle in self.vehicles():
            sensor = vehicle.find(".//sensor")
            self.near(numbers(sensor.find("pose").text), (*self.shipped.laser_place, 0, 0, 0))
            found = [float(sensor.find(f".//{tag}").text) for tag in
                     ("samples", "min_angle", "max_angle", "min", "max", "update_rate")]
            self.near(found, (beams, first, last, nearest, farthest, rate), 1e-6)

    def test_webots_vehicle_has_the_measures_of_the_shipped_one(self):
        robot = next(node for node in self.webots if node["node"] == "Robot")
        parts = list(wbt.below([robot]))
        half, place = self.shipped.chassis
        self.near(robot["boundingObject"]["children"][0]["size"], [2 * side for side in half])
        self.near(robot["boundingObject"]["translation"], place)
        for name, y in (("left", self.shipped.wheel_y), ("right", -self.shipped.wheel_y)):
            joint = next(part for part in parts if part["node"] == "HingeJoint"
                         and part["endPoint"]["name"] == f"wheel_{name}")
            self.near(joint["jointParameters"]["anchor"], (0, y, 0))
            self.near(joint["jointParameters"]["axis"], (0, 1, 0))
            self.near(joint["endPoint"]["translation"], (0, y, 0))
            bounds = joint["endPoint"]["boundingObject"]
            self.near((bounds["radius"], bounds["height"]),
                      (self.shipped.wheel_radius, self.shipped.wheel_width))
            motor = joint["device"][0]
            self.assertEqual(motor["name"], f"wheel_{name}")
            self.assertAlmostEqual(motor["acceleration"] * self.shipped.wheel_radius, self.shipped.limits[2])
            fastest = (self.shipped.limits[0] + self.shipped.limits[1] * self.shipped.wheel_y)
            self.assertGreater(motor["maxVelocity"] * self.shipped.wheel_radius, fastest)
        beams, first, last, nearest, farthest, _ = self.shipped.laser
        laser = next(part for part in parts if part["node"] == "Lidar")
        self.near(laser["translation"], self.shipped.laser_place)
        self.near(laser["rotation"], (1, 0, 0, math.pi))  # upside down: beams from right to left
        self.near((laser["horizontalResolution"], laser["fieldOfView"], laser["minRange"], laser["maxRange"]),
                  (beams, last - first, nearest, farthest), 1e-6)

    def test_steps_are_as_the_page_says(self):
        for path in (GZ_SIM, GAZEBO):
            step = ElementTree.parse(path).find(".//physics/max_step_size").text
            self.assertEqual(float(step), self.shipped.step_s)
        world = next(node for node in self.webots if node["node"] == "WorldInfo")
        self.assertEqual(world["basicTimeStep"], 10)


if __name__ == "__main__":
    sys.exit(unittest.main())
