"""Runs experiments and reads what they leave; for the tests beside this file."""

import hashlib
import json
import pathlib
import signal
import subprocess
import sys
import time

import h5py

sys.path.append(str(pathlib.Path(__file__).parents[1] / "support"))
import recordings  # noqa: E402
from calls import SPIKELOOP, assert_says, refused, spikeloop  # noqa: E402, F401


def programs():
    """The directory of the programs."""
    return pathlib.Path(SPIKELOOP).parent


def new_experiment(path, **keys):
    """What `spikeloop new` prints, with some keys changed."""
    lines = []
    for line in spikeloop("new")[0].splitlines():
        key = line.split(":")[0]
        lines.append(f"{key}: {keys.pop(key)}" if key in keys else line)
    lines += [f"{key}: {value}" for key, value in keys.items()]
    path.write_text("\n".join(lines) + "\n")
    return path


def run(experiment, folder, *more, code=0):
    """The summary of a run, which must end with this exit code; and what was printed."""
    _, said = spikeloop("run", experiment, "--out", folder, "--force", *more, code=code, timeout=None)
    return json.loads((folder / "summary.json").read_text()), said


def started(experiment, folder, *more, command="run"):
    """The process of a run or a replay that has opened its recordings."""
    process = subprocess.Popen([SPIKELOOP, command, str(experiment), "--out", str(folder), *more],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wait(process, lambda: any(folder.glob("*.h5")))
    return process


def wait(process, condition):
    """Until it is fulfilled, while the process runs."""
    while not condition():
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)


def trajectory(folder):
    """Rows of trajectory.csv, also while it is written."""
    return [{name: float(value) for name, value in row.items()}
            for row in recordings.table(folder / "trajectory.csv")]


def wait_for_row(folder, process, wanted):
    """Until trajectory.csv has a row for which wanted(row) is true."""
    wait(process, lambda: any(map(wanted, trajectory(folder))))


def ended(process, code, *expected):
    """The process ends with this code and prints what is expected. Returns all that it printed."""
    printed = "".join(process.communicate(timeout=60))
    assert process.returncode == code, f"exit code {process.returncode}:\n{printed}"
    assert_says(printed, *expected)
    return printed


def interrupt(process, *expected):
    """As Ctrl-C does."""
    process.send_signal(signal.SIGINT)
    return ended(process, 130, *expected)


def fingerprint(folder):
    """Of all recorded spikes, signals and the vehicle's trajectory, to the bit."""
    trajectory = folder / "trajectory.csv"
    digest = hashlib.sha256(trajectory.read_bytes() if trajectory.exists() else b"")
    for path in sorted(folder.glob("*.h5")):
        with h5py.File(path) as file:
            def add(name, item, label=path.name):
                if isinstance(item, h5py.Dataset):
                    digest.update(f"{label}/{name}".encode() + item[()].tobytes())
            file.visititems(add)
    return digest.hexdigest()


def last_values(path):
    """The last values of a node's recorded output."""
    with h5py.File(path) as file:
        return list(file["signals/out/values"][-1])
