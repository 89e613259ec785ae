#!/usr/bin/python3
"""What a script in an experiment is told of the file: its keys carry units, and its directory is the file's."""

import pathlib
import sys
import tempfile

from experiments import runs

EXPERIMENT = """experiment: keys
duration: 10 ms
sync: unpaced
nodes:
  cells:
    simulator: builtin
    network: {{populations: {{p: {{model: poisson, size: 2, parameters: {{rate: 9 Hz}}}}}}, output: [p]}}
  brain:
    simulator: python
    script: models/brain.py
    {key}
  decoder: {{node: rate_window, window: 30 ms}}
connections:
  - cells -> brain [2] -> decoder [2]
"""
BRAIN = """import spikeloop
with spikeloop.music(spikes_in={"in": 2}, spikes_out={"out": 2}, gain=2.0,
                     tau=spikeloop.Parameter(20e-3, unit="s")) as host:
    print("told", host.directory, host.parameters["tau"], host.parameters["gain"])
    for tick in host:
        pass
"""


def says(expected, folder, key, layout, code=0):
    (folder / "experiment.yaml").write_text(EXPERIMENT.format(key=key))
    printed = runs.spikeloop("run", f"{folder.name}/experiment.yaml", "--layout", layout, "--out", "out", "--force",
                             code=code, cwd=folder.parent)
    runs.assert_says("".join(printed), expected)


def main():
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch).resolve() / "here"
        (folder / "models").mkdir(parents=True)
        (folder / "models/brain.py").write_text(BRAIN)
        for layout in ("fused", "separate"):
            says("here/experiment.yaml:11:10: node 'brain': key 'tau': 30 ... tau: 30 ms [SL0202]", folder, "tau: 30",
                 layout, code=2)
            for key, told in (("tau: 30 ms", "0.03 2.0"), ("tau: 0", "0.0 2.0"), ("gain: 3", "0.02 3.0")):
                says(f"told {folder} {told}", folder, key, layout)
    print("scripts in experiments: units, directory")


if __name__ == "__main__":
    sys.exit(main())
