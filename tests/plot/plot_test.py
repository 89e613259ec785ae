#!/usr/bin/python3
"""`spikeloop plot` on the folder of an experiment and of a MUSIC job; its errors."""

import json
import os
import pathlib
import subprocess
import tempfile

import h5py
import numpy as np


def plot(spikeloop, *arguments, code=0, **environment):
    """Names of the pictures and what was said."""
    done = subprocess.run([spikeloop, "plot", *map(str, arguments)], capture_output=True, text=True,
                          check=False, env={**os.environ, **environment})
    assert done.returncode == code, f"{arguments}: exit code {done.returncode}:\n{done.stderr}"
    return [pathlib.Path(line).name for line in done.stdout.splitlines()], done.stderr


def run(spikeloop, *arguments):
    subprocess.run([spikeloop, "run", "-q", *map(str, arguments)], check=True)


def an_experiment(spikeloop, folder):
    """All pictures of a robot's run; the latency is the one that summary.json has."""
    text = subprocess.run([spikeloop, "new"], capture_output=True, text=True, check=True).stdout
    (folder / "explorer.yaml").write_text(text)
    out = folder / "drive"
    run(spikeloop, folder / "explorer.yaml", "--sync", "lockstep", "--duration", "2", "--out", out)
    pictures, said = plot(spikeloop, out)
    assert (pictures, said) == (["trajectory.png", "spikes.png", "signals.png", "latency.png"], "")
    with h5py.File(out / "wheels.h5") as file:
        latency = file["signals/latency"]
        values, times = latency["values"][:, 0], latency["times_ns"][:]
        assert latency["values"].attrs["unit"] in ("ms", b"ms")
    summary = json.loads((out / "summary.json").read_text())
    assert np.sort(values)[(len(values) + 1) // 2 - 1] == summary["latency_median_ms"]
    assert len(values) == summary["scans"] == 40, (len(values), summary["scans"])
    # In lockstep a scan's command leaves a tick later; there is a scan every 50 ms.
    assert np.all(values == 1.0) and np.all(np.diff(times[1:]) == 50_000_000), (values, times)
    pictures, _ = plot(spikeloop, out, "--format", "pdf", "--from", "500 ms", "--to", "1", "--out",
                       folder / "figures")
    assert pictures == ["trajectory.pdf", "spikes.pdf", "signals.pdf", "latency.pdf"], pictures
    return out


def a_music_job(spikeloop, folder, drive):
    (folder / "job.music").write_text(f"""stoptime=1
[scan]
np=1
binary=signal_playback
file={drive}/scan.h5
[cells]
np=1
binary=rate_encoder
[readout]
np=1
binary=spikeloop-node
node=rate_window
scan.out -> cells.in [100]
cells.out -> readout.in [100]
""")
    run(spikeloop, folder / "job.music", "--record", "--out", folder / "job")
    pictures, said = plot(spikeloop, folder / "job")
    assert pictures[0] == "spikes.png", pictures
    assert "no command among what is recorded" in said, said
    assert "latency.png is not drawn: no latency is recorded" in said, said


def errors(spikeloop, folder, drive):
    empty = folder / "empty"
    empty.mkdir()
    fake = folder / "fake" / "matplotlib"
    fake.mkdir(parents=True)
    (fake / "__init__.py").write_text("raise ModuleNotFoundError('gone', name='matplotlib')\n")
    for arguments, environment, code, expected in (
            ((folder / "none",), {}, 4, "none' is not a folder; name the folder"),
            ((empty,), {}, 4, "is not a run folder: it has neither a recording"),
            ((drive, "--from", "2", "--to", "1"), {}, 2,
             "--from 2 is not before --to 1; exchange them"),
            ((drive, "--from", "soon"), {}, 2, "--from: 'soon' is not a moment of a run; write"),
            ((drive, "--to", "-1"), {}, 2, "--to: '-1' is not a moment of a run; write"),
            ((drive, "--format", "gif"), {}, 2, "--format"),
            ((), {}, 2, "RUN is required"),
            ((drive, "--out", "/proc/none"), {}, 4, "cannot make '/proc/none'"),
            ((drive, "--network", "brian"), {}, 1, "did you mean 'brain'?"),
            ((drive,), {"PYTHON": "/nowhere/python3"}, 3, "there is no python3, which draws"),
            ((drive,), {"PYTHONPATH": str(fake.parent)}, 3,
             "Python's package matplotlib is missing")):
        _, said = plot(spikeloop, *arguments, code=code, **environment)
        assert expected in said, f"{arguments}: {said}"


def main():
    spikeloop = str(pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"]) / "spikeloop")
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        drive = an_experiment(spikeloop, folder)
        a_music_job(spikeloop, folder, drive)
        errors(spikeloop, folder, drive)


if __name__ == "__main__":
    main()
