"""Where the simulators' files are."""

import os
import pathlib
import subprocess

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SIMULATORS = SOURCE / "examples" / "simulators"
FOLDERS = [SIMULATORS / name for name in ("gz_sim", "gazebo_classic", "webots")]
PROGRAMS = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])


def spikeloop(*arguments, folder=SIMULATORS):
    """Exit code and output of a command."""
    command = [str(word) for word in (PROGRAMS / "spikeloop", *arguments)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    return done.returncode, done.stdout + done.stderr
