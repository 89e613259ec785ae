"""`spikeloop bench` as a user calls it; for the tests beside this file."""

import json
import os
import pathlib
import subprocess

SPIKELOOP = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"]) / "spikeloop"


def bench(*arguments, code=0, folder=None, **environment):
    """(standard output, standard error)."""
    done = subprocess.run([SPIKELOOP, "bench", *map(str, arguments)], capture_output=True, text=True,
                          check=False, cwd=folder, timeout=400, env={**os.environ, **environment})
    assert done.returncode == code, \
        f"{arguments}: exit code {done.returncode}, not {code}:\n{done.stdout}{done.stderr}"
    return done.stdout, done.stderr


def results(folder):
    return json.loads((folder / "results.json").read_text())
