#!/usr/bin/python3
"""A run folder holds what the run was made of: it is replayed and repeated without the originals."""

import json
import pathlib
import shutil
import unittest

import explorer

PLUGIN = """import spikeloop
@spikeloop.node(inputs={"in": "signal"}, outputs={"out": spikeloop.Signal(same_as="in")}, gain=1.0)
def relay_signal(step, gain):
    'Multiplies'
    if step.changed("in"):
        step.write("out", gain * step.inputs["in"])
"""
NETWORK = """import pathlib
import sizes
from spikeloop.network import Network
def make():
    assert pathlib.Path(__file__).with_name("note.txt").read_text() == "ten"
    net = Network()
    net.population("input", "input", sizes.SIZE)
    net.population("relay", "repeater", 10)
    net.connect("input", "relay", rule="one_to_one", delay="1 ms")
    net.output("relay")
    return net
"""


class SelfContained(explorer.Folder):
    def setUp(self):
        super().setUp()
        self.project = self.folder / "project"
        (self.project / "parts").mkdir(parents=True)
        text = self.file.read_text()
        begin, end = text.index("  brain:"), text.index("  # Speed and turning rate")
        text = text[:begin] + '  brain: {simulator: builtin, network: "parts/brain.py:make"}\n' + text[end:]
        text = text.replace("experiment: explorer", "experiment: explorer\nplugins: [parts/gain.py]")
        text = text.replace("nodes:\n", "nodes:\n  gain: {node: relay_signal}\n", 1)
        text = text.replace("-> sectors", "-> gain -> sectors")
        begin, end = text.index("    weights:\n"), text.index("  wheels:")
        rows = [line.split("- ", 1)[1] for line in text[begin:end].splitlines()[1:]]
        (self.project / "parts/weights.json").write_text(json.dumps([json.loads(row) for row in rows]))
        text = text[:begin] + "    weights: parts/weights.json\n" + text[end:]
        shared = pathlib.Path(explorer.SPIKELOOP).parents[1] / "share/spikeloop"
        shutil.copy(shared / "worlds/arena.xml", self.project / "own.xml")
        self.file = self.project / "explorer.yaml"
        self.file.write_text(text)
        (self.project / "parts/gain.py").write_text(PLUGIN)
        (self.project / "parts/brain.py").write_text(NETWORK)
        (self.project / "parts/sizes.py").write_text("SIZE = 10\n")
        (self.project / "parts/note.txt").write_text("ten")
        explorer.spikeloop("run", self.file, "--sync", "lockstep", "--set", "duration=1 s", "--set", "gain.gain=0.9",
                           "--out", self.folder / "run")
        self.run_folder = self.folder / "elsewhere"
        shutil.move(self.folder / "run", self.run_folder)
        self.spikes = explorer.spikes_of_run(self.run_folder)

    def test_its_files_are_in_it(self):
        found = {str(path.relative_to(self.run_folder / "experiment-files"))
                 for path in (self.run_folder / "experiment-files").rglob("*") if path.is_file()}
        self.assertEqual(found, {"parts/gain.py", "parts/brain.py", "parts/sizes.py", "parts/note.txt",
                                 "parts/weights.json"})

    def test_without_the_originals_it_is_replayed_and_repeated(self):
        shutil.rmtree(self.project)
        _, said = explorer.spikeloop("replay", self.run_folder, "--out", self.folder / "replay")
        self.assertIn("is gone since the run", said)
        self.assertTrue(explorer.same(explorer.spikes_of_run(self.folder / "replay"), self.spikes))
        explorer.spikeloop("run", self.run_folder, "--out", self.folder / "again")
        self.assertTrue(explorer.same(explorer.spikes_of_run(self.folder / "again"), self.spikes))
        explorer.spikeloop("run", self.run_folder, "--set", "gain.gain=0.5", "--out", self.folder / "other")
        self.assertFalse(explorer.same(explorer.spikes_of_run(self.folder / "other"), self.spikes))

    def test_what_has_changed_is_told_and_not_used(self):
        (self.project / "parts/weights.json").write_text(json.dumps([[0] * 10] * 2))
        self.assertIn("weights.json' has changed since ", explorer.spikeloop("replay", self.run_folder)[1])

    def test_a_robots_world_is_in_it(self):
        explorer.spikeloop("run", self.file, "--sync", "lockstep", "--set", "duration=0.2 s", "--set",
                           "robot.world=own.xml", "--out", self.folder / "own")
        shutil.rmtree(self.project)
        explorer.spikeloop("run", self.folder / "own", "--out", self.folder / "own again")
        self.assertTrue(explorer.same(explorer.spikes_of_run(self.folder / "own"),
                                      explorer.spikes_of_run(self.folder / "own again")))

    def test_an_experiment_named_from_another_folder(self):
        explorer.spikeloop("run", "../project/explorer.yaml", "--sync", "lockstep", "--set", "duration=0.2 s", "--out",
                           self.folder / "named", cwd=self.run_folder)
        (self.project / "parts/weights.json").write_text(json.dumps([[0] * 10] * 2))
        explorer.spikeloop("replay", self.folder / "named")

    def test_mistakes(self):
        for command in ("replay", "run"):
            explorer.refused(f"--out: '{self.run_folder}' ... [SL0109]", command, self.run_folder, "--out",
                             self.run_folder, "--force")
        self.assertTrue((self.run_folder / "experiment-files").exists())
        for folder in (self.folder, self.project):
            explorer.refused(f"'{folder}' ... resolved.json ... [SL0109]", "run", folder)
            explorer.refused(f"'{folder}/summary.json' is missing", "summary", folder, code=4)
        explorer.refused("'nowhere' is not a folder", "summary", "nowhere", code=4)
        (self.folder / "results.csv").write_text("run,exit_code\n")
        explorer.refused(f"'{self.folder}' is a sweep: its results are in {self.folder}/results.csv, and each of its "
                         "folders is a run", "summary", self.folder, code=4)
        (self.folder / "summary.json").write_text("5")
        explorer.refused(f"'{self.folder}/summary.json' is not a JSON object", "summary", self.folder, code=4)


if __name__ == "__main__":
    unittest.main()
