#!/usr/bin/python3
"""An experiment over ROS in one process: master (ROS 1), robot and guard are started for it, the robot is
driven, and it stands at the end."""

import contextlib
import json
import pathlib
import sys
import tempfile

import ros
import runs


def drive(scratch, version):
    file = runs.new_experiment(scratch / "explorer.yaml", ros=version, duration="6 s")
    summary, printed = runs.run(file, scratch / "run")
    assert summary["layout"] == "fused" and "finished" in printed, printed
    assert ("ROS master" in printed) == (version == "1"), printed
    assert summary["scans"] > 80 and summary["commands"] > 100, summary
    assert summary["distance_m"] > 0.3 and summary["spikes"] > 1000, summary
    counters = summary["processes"]["experiment"]["counters"]
    assert counters["wheels.stops_ended"] == 1, counters
    last = runs.recordings.table(scratch / "run/trajectory.csv")[-1]
    assert abs(float(last["v_m_s"])) < 0.3, last
    for name in ("encoder.h5", "scan.h5", "wheels.h5", "resolved.json"):
        assert (scratch / "run" / name).exists(), name
    assert json.loads((scratch / "run/resolved.json").read_text())["ros"] == version
    assert summary["file"] == str(file), summary
    # The recorded messages give the same spikes, whichever ROS brought them.
    runs.spikeloop("replay", scratch / "run", "--out", scratch / "again")
    assert json.loads((scratch / "again/summary.json").read_text())["file"] == str(file)
    return summary["latency_median_ms"]


def main():
    for version in "12":
        with tempfile.TemporaryDirectory() as scratch, (
                ros.domain() if version == "2" else contextlib.nullcontext()):
            latency = drive(pathlib.Path(scratch), version)
        print(f"driven over ROS {version} from one process, median {latency:.2f} ms")


if __name__ == "__main__":
    sys.exit(main())
