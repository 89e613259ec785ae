#!/usr/bin/python3
"""The paper's Braitenberg chain end to end: every command is the kernel sum of the known spikes.

Runs robot, ROS, MUSIC and network for some seconds, then computes in NumPy what every command must
have been: y_i(t) = sum_j W_ij sum_s exp(-(t - s) / tau) / tau over the recorded spikes s <= t of the
network (the paper's linear readout).
"""

import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import recordings  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples/01_braitenberg"
PROGRAMS = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])
TAU_S = 0.03
TOLERANCE = 1e-9


def run_job(folder, tick_ms, duration_s):
    for path in EXAMPLE.iterdir():
        if path.is_file():
            shutil.copy(path, folder)
    # Without the example's offset and limits: the commands are the sums themselves.
    (folder / "mapping.json").write_text(json.dumps(
        {"message_type": "Twist", "mapping": {"linear.x": 0, "angular.z": 1}}))
    job = folder / "braitenberg.music"
    text = job.read_text()
    assert "music_timestep=0.001" in text
    job.write_text(text.replace("music_timestep=0.001", f"music_timestep={tick_ms / 1000}"))
    result = subprocess.run(
        [PROGRAMS / "spikeloop", "run", job, "--roscore", "--robot", "--duration",
         str(duration_s), "--record", "--quiet", "--out", folder / "out"],
        capture_output=True, text=True, timeout=90)
    assert result.returncode == 0, f"exit code {result.returncode}\n{result.stdout}{result.stderr}"
    return folder / "out"


def kernel_sums(weights, times_s, spike_times_s, channels):
    """rows x outputs: the readout at each of the times."""
    sums = np.empty((len(times_s), weights.shape[0]))
    order = np.argsort(spike_times_s, kind="stable")
    spike_times_s, channels = spike_times_s[order], channels[order]
    for row, now in enumerate(times_s):
        known = np.searchsorted(spike_times_s, now, side="right")
        # Kernels older than 40 tau are below 1e-17 of their weight.
        first = np.searchsorted(spike_times_s, now - 40 * TAU_S, side="left")
        kernel = np.exp(-(now - spike_times_s[first:known]) / TAU_S) / TAU_S
        sums[row] = weights[:, channels[first:known]] @ kernel
    return sums


def check(out, tick_ms):
    spike_times_ns, channels = recordings.spikes(out, "network")
    times_ns, values = recordings.signal(out, "command", "command")
    weights = np.array(json.loads((EXAMPLE / "readout_weights.json").read_text()))
    tick_ns = round(tick_ms * 1e6)
    # A sink's row is stamped with the end of the interval in which it was received; the value is the
    # decoder's at the interval's begin.
    expected = kernel_sums(weights, (times_ns - tick_ns) * 1e-9, spike_times_ns * 1e-9, channels)
    worst = np.max(np.abs(expected - values))
    print(f"tick {tick_ms:g} ms: {len(spike_times_ns)} spikes, {len(values)} commands, "
          f"largest difference {worst:.2e}, largest command {np.max(np.abs(values)):.3g}")
    assert len(spike_times_ns) > 1000, "the network was nearly silent: nothing is shown"
    assert len(values) > 10, "there were hardly any commands: nothing is shown"
    assert np.max(np.abs(values)) > 0.05, "the robot was hardly commanded: nothing is shown"
    assert worst <= TOLERANCE, f"a command differs from the kernel sum by {worst}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tick-ms", type=float, required=True)
    parser.add_argument("--duration", type=float, default=4.0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        out = run_job(pathlib.Path(name), options.tick_ms, options.duration)
        check(out, options.tick_ms)
    return 0


if __name__ == "__main__":
    sys.exit(main())
