#!/usr/bin/python3
"""A simulator that is not installed is told by `spikeloop check`, with the line of its node."""

import os
import pathlib
import sys
import tempfile

import experiments
from experiments import runs

BRAIN = "simulator: neuron\nscript: brain.py"
BARE = '#!/bin/sh\nexec /usr/bin/python3 -S "$@"\n'  # without site-packages
SLOW = "#!/bin/sh\nexec sleep 20\n"


def check(file, code, *expected, **environment):
    _, said = runs.spikeloop("check", file, code=code, env={**os.environ, **environment})
    runs.assert_says(said, *expected)


def python(scratch, name, text):
    path = scratch / name
    path.write_text(text)
    path.chmod(0o755)
    return str(path)


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        file = experiments.explorer(scratch, BRAIN)
        (scratch / "brain.py").write_text("import spikeloop.neuron\n")
        line = file.read_text().splitlines().index("  brain:") + 1
        bare = python(scratch, "bare", BARE)
        check(file, 3, f"explorer.yaml:{line}:", "node 'brain': simulator 'neuron' is not installed: "
              f"{bare} finds no module 'neuron'; Debian: apt install python3-neuron", PYTHON=bare)
        check(file, 3, "there is no Python to run its script; install it (Debian: apt install python3), or set PYTHON",
              PYTHON=str(scratch / "none"))
        check(file, 0, PYTHON=python(scratch, "slow", SLOW))
        check(file, 0)
    print("what is not installed is told")


if __name__ == "__main__":
    sys.exit(main())
