#!/usr/bin/python3
"""Drives the Braitenberg vehicle through several arenas and checks the result.

    benchmarks/braitenberg/drive_seeds.py [--seeds 1,2,3,4,5] [--duration 60] [--controls]

Each seed must give no collision, a mean speed of at least 0.2 m/s, and at least 30 % of the free
0.5 m cells visited. `--controls` adds the same vehicle without spikes, and with left and right readout
weights swapped: it must collide or not move. Exit code 1 if a check fails.
"""

import argparse
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples/01_braitenberg"
LEAST_SPEED_M_S = 0.2
LEAST_COVERAGE = 0.3
STANDS_STILL_M_S = 0.1


def cut_encoder(folder):
    """No input makes a spike."""
    job = folder / "braitenberg.music"
    text, changes = re.subn(r"rate_(min|max)=\d+", r"rate_\1=0", job.read_text())
    assert changes == 2
    job.write_text(text)


def swap_weights(folder):
    """What the left beams did, the right beams do."""
    path = folder / "readout_weights.json"
    path.write_text(json.dumps([row[::-1] for row in json.loads(path.read_text())]))


def drive(programs, seed, duration, change=None):
    """The summary of one run."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for path in EXAMPLE.iterdir():
            if path.is_file():
                shutil.copy(path, folder)
        if change:
            change(folder)
        result = subprocess.run(
            [programs / "spikeloop", "run", folder / "braitenberg.music", "--roscore", "--robot",
             "--seed", str(seed), "--duration", str(duration), "--quiet", "--out", folder / "out"],
            capture_output=True, text=True, timeout=60 + 3 * duration)
        if result.returncode != 0:
            raise SystemExit(f"seed {seed}: exit code {result.returncode}\n"
                             f"{result.stdout}{result.stderr}")
        return json.loads((folder / "out/summary.json").read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", default="1,2,3,4,5", help="separated by commas")
    parser.add_argument("--duration", type=float, default=60, help="simulated time, s")
    parser.add_argument("--controls", action="store_true", help="also run the controls")
    parser.add_argument("--build", default=ROOT / "build/release", type=pathlib.Path)
    options = parser.parse_args()
    variants = [("as it is", None)]
    if options.controls:
        variants += [("encoder cut", cut_encoder), ("weights swapped", swap_weights)]

    print("vehicle          seed  collisions  mean speed  coverage  real-time factor  verdict")
    failures = 0
    for label, change in variants:
        for seed in (int(text) for text in options.seeds.split(",")):
            run = drive(options.build.resolve() / "bin", seed, options.duration, change)
            collisions, speed = run["collisions"], run["mean_speed_m_s"]
            explores = (collisions == 0 and speed >= LEAST_SPEED_M_S
                        and run["coverage"] >= LEAST_COVERAGE)
            good = collisions > 0 or speed < STANDS_STILL_M_S if change else explores
            failures += not good
            print(f"{label:<16} {seed:>4}  {collisions:>10}  {speed:>6.2f} m/s  "
                  f"{100 * run['coverage']:>6.0f} %  {run['real_time_factor']:>16.3f}  "
                  f"{'as it must be' if good else 'NOT AS IT MUST BE'}", flush=True)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
