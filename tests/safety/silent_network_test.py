#!/usr/bin/python3
"""spike_timeout in one process: a network that falls silent stops the robot where that is asked for, at its
simulated time, and nowhere else; the separate layout refuses the key."""

import json
import pathlib
import subprocess
import sys
import tempfile

EXPERIMENT = """experiment: silent
duration: 3 s
sync: lockstep
robot: {{simulator: mujoco}}
nodes:
  scan: {{node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}}
  encoder: {{node: rate_encoder, rate_max: 0.001 Hz, rate_min: 0 Hz}}
  decoder: {{node: linear_readout, weights: uniform}}
  wheels: {{node: ros_command, topic: /cmd_vel, message: Twist, limits: none,
           fields: {{linear.x: {{channel: 0, offset: 0.1}}}}{more}}}
connections:
  - scan -> encoder [100] -> decoder [100] -> wheels [1]
"""


def run(spikeloop, folder, more):
    (folder / "silent.yaml").write_text(EXPERIMENT.format(more=more))
    done = subprocess.run([spikeloop, "run", str(folder / "silent.yaml"), "--out", str(folder / "run")],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done
    return done, json.loads((folder / "run/summary.json").read_text())


def main():
    spikeloop = str(pathlib.Path(sys.argv[1]).resolve() / "spikeloop")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        done, summary = run(spikeloop, folder, "")
        assert summary["counters"]["wheels.stops_no_spike"] == 0 and summary["distance_m"] > 0.2, summary
        driven = summary["distance_m"]
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        done, summary = run(spikeloop, folder, ", spike_timeout: 1 s")
        assert summary["counters"]["wheels.stops_no_spike"] == 1, summary
        assert 0 < summary["distance_m"] < 0.6 * driven, (summary["distance_m"], driven)
        assert "node 'wheels': the robot is stopped at 1.002 s: no spike has come for spike_timeout, 1 s" \
            in done.stderr, done.stderr
        separate = (folder / "silent.yaml").read_text().replace("lockstep", "realtime\nros: 1")
        (folder / "silent.yaml").write_text(separate)
        done = subprocess.run([spikeloop, "export", str(folder / "silent.yaml"), "--out",
                               str(folder / "job")], capture_output=True, text=True, check=False)
        assert done.returncode == 2 and "silent.yaml:" in done.stderr and "key 'spike_timeout': the " \
            "separate layout has none, because no spike reaches the command's process; leave it out, " \
            "or use the fused layout" in done.stderr, done
    print("a silent network stops the robot where that is asked for")


if __name__ == "__main__":
    sys.exit(main())
