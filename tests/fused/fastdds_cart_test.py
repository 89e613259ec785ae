#!/usr/bin/python3
"""Lockstep with a robot on another vendor's DDS that stays for one run after the other: each run gets the robot's first
messages, and is bit-identical to a recurrence by hand."""

import pathlib
import sys
import tempfile

import ros
import stepping_test

RUNS = 5


def main():
    count = int(sys.argv[2]) if len(sys.argv) > 2 else RUNS
    with tempfile.TemporaryDirectory() as scratch, ros.domain() as domain:
        scratch = pathlib.Path(scratch)
        file = scratch / "cart.yaml"
        file.write_text(stepping_test.EXPERIMENT)
        with ros.program(sys.argv[1], domain):
            for number in range(count):
                stepping_test.follows_the_recurrence(file, scratch / f"run{number}", "--ros", "2")
    print(f"{count} runs with one robot, bit-identical")


if __name__ == "__main__":
    sys.exit(main())
