#!/usr/bin/python3
"""An experiment over ROS 1 in one process: master, robot and guard are started for it, the robot is
driven, and it stands at the end."""

import csv
import pathlib
import sys
import tempfile

import runs


def main():
    spikeloop = str(runs.programs() / "spikeloop")
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        file = runs.new_experiment(spikeloop, scratch / "explorer.yaml", ros="1", duration="6 s")
        summary, printed = runs.run(spikeloop, file, scratch / "run")
        assert summary["layout"] == "fused" and "finished" in printed, printed
        assert summary["scans"] > 80 and summary["commands"] > 100, summary
        assert summary["distance_m"] > 0.3 and summary["spikes"] > 1000, summary
        counters = summary["processes"]["experiment"]["counters"]
        assert counters["wheels.stops_ended"] == 1, counters
        with open(scratch / "run/trajectory.csv", encoding="utf-8") as table:
            last = list(csv.DictReader(table))[-1]
        assert abs(float(last["v_m_s"])) < 0.3, last
        for name in ("encoder.h5", "scan.h5", "wheels.h5", "resolved.json"):
            assert (scratch / "run" / name).exists(), name
    print("driven over ROS 1 from one process, median",
          f"{summary['latency_median_ms']:.2f} ms")


if __name__ == "__main__":
    sys.exit(main())
