#!/usr/bin/python3
"""What a script in an experiment is told of the file: its keys carry units, and its directory is the file's."""

import os
import pathlib
import subprocess
import sys
import tempfile

PROGRAMS = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])
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


def said(folder, key, layout, code=0):
    (folder / "experiment.yaml").write_text(EXPERIMENT.format(key=key))
    done = subprocess.run([str(PROGRAMS / "spikeloop"), "run", f"{folder.name}/experiment.yaml", "--layout",
                           layout, "--out", "out", "--force"], cwd=folder.parent, capture_output=True, text=True,
                          check=False, timeout=120)
    assert done.returncode == code, done
    return done.stdout + done.stderr


def main():
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch).resolve() / "here"
        (folder / "models").mkdir(parents=True)
        (folder / "models/brain.py").write_text(BRAIN)
        for layout in ("fused", "separate"):
            printed = said(folder, "tau: 30", layout, code=2)
            assert "here/experiment.yaml:11:10: node 'brain': key 'tau': 30 has no unit; " \
                "write for example  tau: 30 ms" in printed, printed
            for key, told in (("tau: 30 ms", "0.03 2.0"), ("tau: 0", "0.0 2.0"), ("gain: 3", "0.02 3.0")):
                printed = said(folder, key, layout)
                assert f"told {folder} {told}" in printed, printed
    print("scripts in experiments: units, directory")


if __name__ == "__main__":
    sys.exit(main())
