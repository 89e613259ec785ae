#!/usr/bin/python3
"""Experiments for other simulators are sound, take example 1's loop, and pages name files that exist."""

import re
import sys
import unittest
import xml.etree.ElementTree as ElementTree

import wbt
import yaml
from folders import FOLDERS, SIMULATORS, spikeloop

EXPERIMENTS = sorted(SIMULATORS.glob("*/braitenberg*.yaml"))


def step_s(folder):
    world = next(path for path in folder.iterdir() if path.name.startswith("arena."))
    if world.suffix == ".wbt":
        nodes = wbt.read(world.read_text(encoding="utf-8"))
        return next(node["basicTimeStep"] for node in nodes if node["node"] == "WorldInfo") / 1000
    return float(ElementTree.parse(world).find(".//max_step_size").text)


class Experiments(unittest.TestCase):
    def test_every_folder_has_one(self):
        self.assertEqual({path.parent for path in EXPERIMENTS}, set(FOLDERS))

    def test_check_finds_nothing_wrong(self):
        for path in EXPERIMENTS:
            with self.subTest(path.parent.name + "/" + path.name):
                code, said = spikeloop("check", path.name, folder=path.parent)
                self.assertEqual(code, 0, said)
                self.assertIn("OK: 5 nodes, 4 connections", said)

    def test_the_loop_is_that_of_example_1(self):
        known = SIMULATORS.parent / "01_braitenberg/braitenberg.yaml"
        first = yaml.safe_load(known.read_text(encoding="utf-8"))
        for path in EXPERIMENTS:
            text = path.read_text(encoding="utf-8")
            loop = yaml.safe_load(text.replace("../../01_braitenberg/", ""))
            self.assertEqual(loop["connections"], first["connections"])
            self.assertEqual(loop["nodes"], first["nodes"])

    def test_a_tick_is_a_step_of_the_simulator(self):
        for path in EXPERIMENTS:
            tick = yaml.safe_load(path.read_text(encoding="utf-8"))["tick"]
            self.assertEqual(tick, f"{1000 * step_s(path.parent):g} ms", path)


class Pages(unittest.TestCase):
    def test_the_table_of_a_page_has_every_file(self):
        for folder in FOLDERS:
            page = (folder / "README.md").read_text(encoding="utf-8")
            rows = [line.split("|")[1] for line in page.splitlines() if line.startswith("| `")]
            told = set(re.findall(r"`([^`]+)`", " ".join(rows)))
            there = {path.name for path in folder.iterdir()} - {"README.md", "__pycache__", "runs"}
            self.assertEqual(told, there, folder)

    def test_commands_name_files_that_exist(self):
        for folder in FOLDERS:
            page = (folder / "README.md").read_text(encoding="utf-8")
            commands = [line.split() for line in page.splitlines() if line.startswith("    ")]
            starts = [words for words in commands if words[0] in ("ros2", "roslaunch", "spikeloop")]
            self.assertGreaterEqual(len(starts), 3)
            for words in starts:
                file = words[1] if words[0] == "roslaunch" else words[2]
                self.assertTrue((folder / file).is_file(), words)


if __name__ == "__main__":
    sys.exit(unittest.main())
