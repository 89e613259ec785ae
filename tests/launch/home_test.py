#!/usr/bin/python3
"""A user without an entry in the user database runs a job under mpirun and draws its figures: without HOME, and with a
HOME in which the user cannot write."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
from calls import SPIKELOOP, TWO_PROGRAMS  # noqa: E402

USER = 54321
AS_USER = {"user": USER, "group": USER, "extra_groups": []}


def readable_copy(folder):
    """Copies the programs to a folder that the user can read: the project may be in a folder of root."""
    release = pathlib.Path(SPIKELOOP).parents[1]
    for part in ("bin", "lib/spikeloop", "share"):
        shutil.copytree(release / part, folder / "release" / part)
    return folder / "release"


def call(release, folder, home, *words):
    environment = {name: value for name, value in os.environ.items() if name not in ("HOME", "MPLCONFIGDIR")}
    done = subprocess.run([release / "bin/spikeloop", *words], env={**environment, "TMPDIR": str(folder), **home},
                          cwd=folder, capture_output=True, text=True, timeout=120, **AS_USER)
    assert done.returncode == 0, done
    assert "Traceback" not in done.stderr and "matplotlib" not in done.stderr.lower(), done.stderr


def main():
    if os.getuid() != 0:
        print("only root may become another user")
        return
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        os.chown(folder, USER, USER)
        release = readable_copy(folder)
        (folder / "cycle.yaml").write_text(TWO_PROGRAMS)
        for number, home in enumerate(({}, {"HOME": "/"})):
            call(release, folder, home, "run", "cycle.yaml", "--out", f"run{number}")
            call(release, folder, home, "plot", f"run{number}")
            assert list((folder / f"run{number}").glob("*.png"))
        # Python that `spikeloop` has not started.
        subprocess.run([sys.executable, "-c", "import spikeloop, matplotlib"], cwd=folder, check=True, timeout=120,
                       env={"PYTHONPATH": str(release / "share/spikeloop/python"), "TMPDIR": str(folder)}, **AS_USER)


main()
