#!/usr/bin/python3
"""A user without an entry in the user database runs a job under mpirun and draws its figures: without HOME, and with a
HOME in which the user cannot write."""

import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
from calls import SPIKELOOP, TWO_PROGRAMS  # noqa: E402

USER = 54321
# This user may read all files: the programs may be in a folder of root.
AS_USER = ["setpriv", f"--reuid={USER}", f"--regid={USER}", "--clear-groups", "--inh-caps=+dac_read_search",
           "--ambient-caps=+dac_read_search"]


def call(folder, home, *words):
    environment = {name: value for name, value in os.environ.items() if name not in ("HOME", "MPLCONFIGDIR")}
    done = subprocess.run([*AS_USER, SPIKELOOP, *words], env={**environment, "TMPDIR": str(folder), **home}, cwd=folder,
                          capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done
    assert "Traceback" not in done.stderr and "matplotlib" not in done.stderr.lower(), done.stderr


def main():
    if os.getuid() != 0:
        print("only root may become another user")
        return
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        os.chown(folder, USER, USER)
        (folder / "cycle.yaml").write_text(TWO_PROGRAMS)
        for number, home in enumerate(({}, {"HOME": "/"})):
            call(folder, home, "run", "cycle.yaml", "--out", f"run{number}")
            call(folder, home, "plot", f"run{number}")
            assert list((folder / f"run{number}").glob("*.png"))
        # Python that `spikeloop` has not started.
        subprocess.run([*AS_USER, sys.executable, "-c", "import spikeloop, matplotlib"],
                       cwd=folder, env={"PYTHONPATH": str(pathlib.Path(__file__).parents[2] / "python"),
                                        "TMPDIR": str(folder)}, check=True, timeout=120)


main()
