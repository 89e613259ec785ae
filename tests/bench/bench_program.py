"""`spikeloop bench` as a user calls it; for the tests beside this file."""

import json
import os
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from calls import SPIKELOOP, assert_says, spikeloop  # noqa: E402, F401
from folder import FolderCase  # noqa: E402, F401


def bench(*arguments, code=0, folder=None, **environment):
    """(standard output, standard error)."""
    return spikeloop("bench", *arguments, code=code, cwd=folder, timeout=400, env={**os.environ, **environment})


def results(folder):
    return json.loads((folder / "results.json").read_text())
