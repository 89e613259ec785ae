#!/usr/bin/python3
"""Measures the time from STOP in the live view to the zero command at a robot over ROS 2 on Fast DDS, while other
clients attack the server on loopback. Prints a table in Markdown."""

import argparse
import os
import pathlib
import statistics
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
os.environ.setdefault("SPIKELOOP_PROGRAMS", str(ROOT / "build/release/bin"))
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("live", "safety", "fused", "support")]
import attacked  # noqa: E402

ATTACKS = (("none", None, 0), ("8 viewers, 10,000 subscriptions each", "subscribers", 8),
           ("16 viewers, 10,000 subscriptions each", "subscribers", 16),
           ("2,000 connections", "connections", 2000), ("4 viewers, frames of 100 MB", "frames", 4))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repetitions", type=int, default=100, help="STOPs of each attack (100)")
    parser.add_argument("--attack", default="", help="only those whose name has these words")
    arguments = parser.parse_args()
    print("| attack | STOPs | median | worst |\n|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder, attacked.robot(pathlib.Path(folder)) as robot:
        for name, kind, count in ATTACKS:
            if arguments.attack in name:
                times = attacked.times_to_zero(robot, pathlib.Path(folder), kind, count, arguments.repetitions)
                print(f"| {name} | {len(times)} | {statistics.median(times):.0f} ms | {max(times):.0f} ms |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
