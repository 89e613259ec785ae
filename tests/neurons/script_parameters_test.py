"""Arguments of a network's function as keys of its node: as by hand, checked, swept, replayed, exported."""

import json
import subprocess
import unittest

import numpy as np

import built_in

# Cells that fire regularly, from a current alone: theory gives their interval.
SCRIPT = """\
import spikeloop
import spikeloop.network


def make(current=spikeloop.Parameter(400, unit="pA", minimum=0, text="Input current"), cells=2,
         model=spikeloop.Parameter("iaf_psc_exp", choices=["iaf_psc_exp", "iaf_psc_delta"]), extra=None):
    net = spikeloop.network.Network()
    net.population("cell", model, len(range(cells)), I_e=current)
    if extra:
        net.population("extra", "repeater", sum(extra))
    net.output("cell")
    return net


def bare(weight, cells):
    assert (weight, cells) == ("20 pA", 3), (weight, cells)
    net = spikeloop.network.Network()
    net.population("cell", "iaf_psc_exp", 3, I_e=400)
    net.output("cell")
    return net
"""
C_M, TAU_M, T_REF, RISE = 250.0, 10.0, 2.0, 15.0  # pF, ms, ms, mV: the model's defaults


def spikes_in(duration_ms, current):
    """Of one cell, on the grid of 0.1 ms (Rotter & Diesmann 1999): first at the grid point after the threshold."""
    rise = -TAU_M * np.log(1 - RISE * C_M / (current * TAU_M))
    steps = int(np.ceil(rise / 0.1 - 1e-9))
    return int((duration_ms / 0.1 - steps) // (steps + T_REF / 0.1)) + 1


class Case(built_in.FolderCase):
    def setUp(self):
        super().setUp()
        (self.folder / "brain.py").write_text(SCRIPT)
        self.experiment()

    def experiment(self, keys="", network="brain.py:make"):
        (self.folder / "e.yaml").write_text(f"""\
experiment: e
duration: 0.3 s
sync: unpaced
nodes:
  brain: {{simulator: builtin, network: "{network}"{keys}}}
  rate: {{node: rate_window}}
connections: [brain -> rate]
""")

    def spikeloop(self, *words, code=0):
        return "".join(built_in.spikeloop(*words, code=code, cwd=self.folder))

    def counts(self, folder):
        """Of each cell."""
        run = built_in.Run(self.folder / folder, "")
        return np.bincount(run.stream("out").channels).tolist()

    def run_it(self, folder, *words):
        self.spikeloop("run", "e.yaml", "--out", folder, *words)
        return self.counts(folder)


class Values(Case):
    def test_defaults_keys_and_settings(self):
        self.assertEqual(self.run_it("a"), [spikes_in(300, 400)] * 2)
        self.experiment(", current: 0.5 nA, cells: 3, model: iaf_psc_delta, extra: [1, 2]")
        self.assertEqual(self.run_it("b"), [spikes_in(300, 500)] * 3)
        self.assertEqual(self.run_it("c", "--set", "brain.current=600 pA"), [spikes_in(300, 600)] * 3)
        nodes = json.loads((self.folder / "c" / "resolved.json").read_text())["nodes"]
        self.assertEqual({key: nodes["brain"][key] for key in ("current", "cells", "model")},
                         {"current": 600, "cells": 3, "model": "iaf_psc_delta"})

    def test_arguments_without_a_declaration_are_as_written(self):
        self.experiment(", weight: 20 pA, cells: 3", "brain.py:bare")
        self.assertEqual(len(self.run_it("a")), 3)

    def test_separate_processes_replay_and_sweep(self):
        self.experiment(", cells: 3")
        setting = ("--set", "brain.current=500 pA")
        self.assertEqual(self.run_it("apart", *setting, "--layout", "separate"), [spikes_in(300, 500)] * 3)
        self.assertEqual(self.run_it("run", *setting), [spikes_in(300, 500)] * 3)
        self.assertNotIn("differ", self.spikeloop("replay", "run"))
        self.spikeloop("sweep", "e.yaml", "--set", "brain.current=[400 pA, 600 pA]", "--columns", "brain.spikes",
                       "--out", "sweep")
        table = built_in.recordings.table(self.folder / "sweep" / "results.csv")
        self.assertEqual([(row["brain.current"], int(row["brain.spikes"])) for row in table],
                         [(f"{current} pA", 3 * spikes_in(300, current)) for current in (400, 600)])

    def test_a_job_has_them_in_its_section(self):
        self.experiment(", current: 600 pA, cells: 3")
        self.spikeloop("export", "e.yaml", "--out", "job")
        job = self.folder / "job" / "experiment.music"
        self.assertIn("current=600 pA", job.read_text())
        self.spikeloop("run", job, "--out", "run")
        summary = json.loads((self.folder / "run" / "summary.json").read_text())
        self.assertEqual(summary["spikes"], 3 * spikes_in(300, 600))
        self.assertIn("current: 600 pA", self.spikeloop("import", job))


class Mistakes(Case):
    def refused(self, expected, keys, network="brain.py:make"):
        self.experiment(keys, network)
        built_in.refused(f"e.yaml:5 ... {expected}", "check", "e.yaml", cwd=self.folder)

    def test_an_unknown_key(self):
        self.refused("node 'brain': unknown key 'curent'; did you mean 'current'? [SL0103]", ", curent: 400 pA")
        (self.folder / "brain.yaml").write_text("populations: {p: {model: repeater, size: 1}}\noutput: [p]\n")
        self.refused("'current' ... [SL0103]", ", current: 400 pA", "brain.yaml")

    def test_values(self):
        for keys, text in ((", current: 400", "key 'current': 400 ... current: 400 pA [SL0202]"),
                           (", current: 20 mV", "key 'current': ... 'mV' ... [SL0202]"),
                           (", current: -1 pA", "key 'current': -1 ... [SL0203]"),
                           (", cells: many", "key 'cells': 'many' ... [SL0201]"),
                           (", model: iaf_psc_ex", "key 'model': ... 'iaf_psc_exp'? ... [SL0205]")):
            self.refused(text, keys)
        self.assertIn("--set brain.cells", self.spikeloop("check", "e.yaml", "--set", "brain.cells=few", code=2))

    def test_one_is_missing(self):
        self.refused("node 'brain': key 'weight' is missing (Argument of bare()); write  weight: ...", ", cells: 3",
                     "brain.py:bare")
        done = subprocess.run([built_in.PROGRAMS / "spikeloop-network", "--check", "brain.py:bare"], cwd=self.folder,
                              capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("key 'weight' is missing", done.stderr)

    def test_a_name_that_all_programs_have(self):
        (self.folder / "brain.py").write_text(SCRIPT.replace("extra=None", "seed=1"))
        self.refused("node 'brain': 'seed' ... [SL0106]", ", seed: 3")

    def test_a_name_that_the_node_has(self):
        for name in ("record", "network", "simulator"):
            (self.folder / "brain.py").write_text(SCRIPT.replace("extra=None", f"{name}=True"))
            self.refused(f"the function's argument '{name}' has the name of a key of the node", "")

    def test_an_error_of_the_file_is_the_only_one(self):
        (self.folder / "brain.py").write_text(SCRIPT + "1 / 0\n")
        self.experiment(", curent: 400 pA")
        text = self.spikeloop("check", "e.yaml", code=2)
        self.assertIn("ZeroDivisionError", text)
        self.assertNotIn("curent", text)


class Page(Case):
    def test_the_function_of_the_page(self):
        page = (built_in.HERE.parents[1] / "docs/network-file.md").read_text()
        block = next(block for block in page.split("```python\n")[1:] if "Parameter" in block).split("```")[0]
        (self.folder / "brain.py").write_text(block)
        brain = next(line.strip() for line in page.splitlines() if line.startswith("    brain: {"))
        (self.folder / "e.yaml").write_text(f"""\
ros: 2
nodes:
  scan: {{node: ros_sensor, topic: /x, message: std_msgs/Float64MultiArray}}
  noise: {{node: poisson_encoder}}
  {brain}
  rate: {{node: rate_window}}
connections: ["scan -> noise [100] -> brain -> rate [80]"]
""")
        self.spikeloop("check", "e.yaml", "--set", "brain.cells=80")


if __name__ == "__main__":
    unittest.main()
