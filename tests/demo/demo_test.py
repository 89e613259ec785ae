#!/usr/bin/python3
"""scripts/demo as a newcomer calls it, for 5 s: over ROS 1, over ROS 2, and in lockstep.

  demo_test.py 1|2|lockstep
"""

import contextlib
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests/fused"))
import ros  # noqa: E402

PICTURES = ("trajectory.png", "spikes.png", "signals.png")


def main():
    transport = sys.argv[1]
    options = ["--lockstep"] if transport == "lockstep" else ["--ros", transport, "--duration", "5"]
    with tempfile.TemporaryDirectory() as folder, (
            ros.domain() if transport == "2" else contextlib.nullcontext()):
        out = pathlib.Path(folder) / "out"
        printed = subprocess.run([ROOT / "scripts/demo", "--no-build", *options, "--out", out], check=True,
                                 stdout=subprocess.PIPE, text=True).stdout
        print(printed)
        summary = json.loads((out / "summary.json").read_text())
        assert summary["exit_code"] == 0 and summary["collisions"] == 0, summary
        assert summary["distance_m"] > 0.2 * summary["simulated_s"], summary
        wanted = PICTURES if transport == "lockstep" else (*PICTURES, "latency.png")
        missing = [name for name in wanted if not (out / name).exists()]
        assert not missing and "distance driven" in printed, (missing, printed)


if __name__ == "__main__":
    sys.exit(main())
