#!/usr/bin/python3
"""A network five times slower than real time: data stay fresh enough, or the robot is stopped.

MUSIC lets a source run far ahead of a slow receiver; the data_stamp connection must keep the age of the
data behind every command bounded, the run must report it, and past max_age the robot must stop.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

PROGRAMS = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])
JOB = """stoptime=1
music_timestep=0.001
[sensor]
  np=1
  binary=ros_sensor_adapter
  ros_topic=/scan
  message_type=LaserScan
[encoder]
  np=1
  binary=rate_encoder
  rate_min=1
  rate_max=200
[network]
  np=1
  binary=spikeloop-node
  node=slow_relay
  plugin={plugin}
  cost=0.005
[decoder]
  np=1
  binary=linear_readout_decoder
  weights=uniform:0.00002
[command]
  np=1
  binary=ros_command_adapter
  ros_topic=/cmd_vel
  message_mapping_filename=mapping.json
  max_age={max_age}
sensor.out -> encoder.in [100]
encoder.out -> network.in [100]
network.out -> decoder.in [100]
decoder.out -> command.in [1]
"""
# A scan is up to 50 ms old when it is used; beside that, a few ticks of 5 ms each.
LATENCY_BOUND_MS = 200
# A busy machine may stand still in between. Without `data_stamp`, the sensor would be up to 4 s ahead.
AGE_BOUND_MS = 1500


def run(plugin, max_age, exit_codes=(0,)):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "job.music").write_text(JOB.format(plugin=plugin, max_age=max_age))
        (folder / "mapping.json").write_text('{"message_type": "Twist", "mapping": {"linear.x": 0}}')
        result = subprocess.run(
            [PROGRAMS / "spikeloop", "run", folder / "job.music", "--roscore", "--robot", "--quiet",
             "--out", folder / "out"], capture_output=True, text=True, timeout=100)
        assert result.returncode in exit_codes, f"exit {result.returncode}\n{result.stdout}{result.stderr}"
        summary = json.loads((folder / "out/summary.json").read_text())
        assert result.returncode == 0 or "older than max_age" in summary["exit_reason"], summary
        return summary


def fresh_data(plugin):
    fresh = run(plugin, 10)
    print(f"max_age 10 s: real-time factor {fresh['real_time_factor']:.2f}, latency median "
          f"{fresh['latency_median_ms']:.0f} ms, oldest data {fresh['age_max_ms']:.0f} ms, "
          f"{fresh['distance_m']:.2f} m driven")
    assert fresh["real_time_factor"] < 0.3, "the network was not slow: nothing is shown"
    assert fresh["latency_median_ms"] < LATENCY_BOUND_MS, "the data are old"
    assert fresh["age_max_ms"] < AGE_BOUND_MS, "the age of the data is not bounded"
    assert fresh["distance_m"] > 0.1, "the robot did not drive: nothing is shown"


def stale_data(plugin):
    # Whether the data were old in the last tick, too, or whether that was late, is chance.
    stale = run(plugin, 0.01, exit_codes=(0, 3))
    oldest = stale["age_max_ms"]  # None if no command was sent
    print(f"max_age 10 ms: oldest data of a command {oldest} ms, {stale['distance_m']:.2f} m driven")
    assert stale["distance_m"] < 0.05, "the robot was driven on data older than max_age"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", choices=["fresh", "stale"])
    parser.add_argument("--plugin", type=pathlib.Path, required=True)
    options = parser.parse_args()
    (fresh_data if options.data == "fresh" else stale_data)(options.plugin)
    return 0


if __name__ == "__main__":
    sys.exit(main())
