#!/usr/bin/python3
"""A simulator that is not installed is told by `spikeloop check`, with the line of its node."""

import os
import pathlib
import subprocess
import sys
import tempfile

import experiments

BRAIN = "simulator: neuron\nscript: brain.py"
BARE = '#!/bin/sh\nexec /usr/bin/python3 -S "$@"\n'  # without site-packages
SLOW = "#!/bin/sh\nexec sleep 20\n"


def check(file, code, **environment):
    done = subprocess.run([experiments.SPIKELOOP, "check", str(file)], capture_output=True, text=True,
                          env={**os.environ, **environment}, timeout=60, check=False)
    assert done.returncode == code, (done.returncode, done.stdout, done.stderr)
    return done.stdout + done.stderr


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
        said = check(file, 3, PYTHON=bare)
        place = f"explorer.yaml:{line}:"
        assert place in said, said
        assert (f"node 'brain': simulator 'neuron' is not installed: {bare} finds no module 'neuron'; "
                "Debian: apt install python3-neuron") in said, said
        said = check(file, 3, PYTHON=str(scratch / "none"))
        assert ("there is no Python to run its script; install it (Debian: apt install python3), or "
                "set PYTHON") in said, said
        check(file, 0, PYTHON=python(scratch, "slow", SLOW))
        check(file, 0)
    print("what is not installed is told")


if __name__ == "__main__":
    sys.exit(main())
