"""Runs experiments and reads what they leave; for the tests beside this file."""

import hashlib
import json
import os
import pathlib
import subprocess
import sys

import h5py

sys.path.append(str(pathlib.Path(__file__).parents[1] / "support"))
from calls import assert_says, refused, spikeloop  # noqa: E402, F401


def programs():
    """The directory of the programs."""
    return pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])


def new_experiment(spikeloop, path, **keys):
    """What `spikeloop new` prints, with some keys changed."""
    text = subprocess.run([spikeloop, "new"], capture_output=True, text=True, check=True).stdout
    lines = []
    for line in text.splitlines():
        key = line.split(":")[0]
        lines.append(f"{key}: {keys.pop(key)}" if key in keys else line)
    lines += [f"{key}: {value}" for key, value in keys.items()]
    path.write_text("\n".join(lines) + "\n")
    return path


def run(spikeloop, experiment, folder, *more, code=0):
    """The summary of a run, which must end with this exit code; and what was printed."""
    done = subprocess.run([spikeloop, "run", str(experiment), "--out", str(folder), "--force", *more],
                          capture_output=True, text=True, check=False)
    assert done.returncode == code, f"exit code {done.returncode}:\n{done.stderr}"
    return json.loads((folder / "summary.json").read_text()), done.stderr


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
