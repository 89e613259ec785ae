#!/usr/bin/python3
"""spike_timeout in one process, its robot there or over ROS 1 or 2: a network that falls silent stops the robot where that is asked for, at its
simulated time, and nowhere else; an exported job refuses the key."""

import contextlib
import pathlib
import sys
import tempfile

from robots import ros, runs

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


def run(folder, version, more):
    (folder / "silent.yaml").write_text(EXPERIMENT.format(more=more))
    over = ["--ros", version] if version else []
    summary, said = runs.run(folder / "silent.yaml", folder / "run", *over)
    counters = summary["processes"]["experiment"]["counters"] if version else summary["counters"]
    return said, summary["distance_m"], counters["wheels.stops_no_spike"]


def stops(version):
    """Where it is asked for, at its time."""
    with tempfile.TemporaryDirectory() as folder:
        _, driven, stopped = run(pathlib.Path(folder), version, "")
        assert stopped == 0 and driven > 0.2, (stopped, driven)
    with tempfile.TemporaryDirectory() as folder:
        said, distance, stopped = run(pathlib.Path(folder), version, ", spike_timeout: 1 s")
    assert stopped == 1 and 0 < distance < 0.6 * driven, (stopped, distance, driven)
    runs.assert_says(said, "node 'wheels' at 1.002 s: ... spike_timeout, 1 s")


def is_refused():
    """In an exported job."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "silent.yaml"
        file.write_text(EXPERIMENT.format(more=", spike_timeout: 1 s").replace("lockstep", "realtime\nros: 2"))
        runs.refused("silent.yaml ... key 'spike_timeout': an exported job has none, because no spike reaches the "
                     "command's program; leave it out", "export", file, "--out", folder + "/job")


def main():
    is_refused()
    for version in ("", "1", "2"):
        with ros.domain() if version == "2" else contextlib.nullcontext():
            stops(version)
    print("a silent network stops the robot where that is asked for")


if __name__ == "__main__":
    sys.exit(main())
