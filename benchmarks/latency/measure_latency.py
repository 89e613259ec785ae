#!/usr/bin/python3
"""Latency from a scan to the first command that follows it, over the tick: the paper's figure.

    benchmarks/latency/measure_latency.py [--ticks 1,10,50] [--trials 100] [--network]
                                          [--layouts separate,fused] [--json FILE]

Protocol: one channel, a scan at 20 Hz that steps from minimum to maximum at random moments, rate
encoder with rate_max 1000 Hz, deadband 0. Separate: every program a process of its own, joined by
MUSIC; fused: the same as an experiment in one process. `--network` puts a repeater of the built-in
network between encoder and decoder. The command adapter's own measurement
(message arrived to command computed) is the share of encoder and MUSIC; the rest is ROS, and the
time for which a command is held because the last one left less than half a tick ago.
"""

import argparse
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]

JOB = """stoptime=100000
music_timestep={tick_s}

[sensor]
  np=1
  binary=ros_sensor_adapter
  ros_topic=/scan
  message_type=LaserScan
[encoder]
  np=1
  binary=rate_encoder
  rate_min=0
  rate_max=1000
{network}[decoder]
  np=1
  binary=linear_readout_decoder
  tau=0.03
  weights=uniform
[command]
  np=1
  binary=ros_command_adapter
  ros_topic=/cmd_vel
  deadband=0
  message_mapping_filename=mapping.json

sensor.out -> encoder.in [1]
{spikes}
decoder.out -> command.in [1]
"""
NETWORK = """[network]
  np=1
  binary=spikeloop-network
  network=network.yaml
"""
REPEATER = """resolution: 0.1 ms
populations:
  input: {model: input, size: 1}
  relay: {model: repeater, size: 1}
connections:
  - {from: input, to: relay, rule: one_to_one, weight: 1, delay: 0.1 ms}
output: [relay]
"""
EXPERIMENT = """experiment: latency
tick: {tick_ms:g} ms
ros: 1
nodes:
  scan: {{node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}}
  encoder: {{node: rate_encoder, rate_max: 1000 Hz}}
{network}  decoder: {{node: linear_readout, tau: 30 ms, weights: uniform}}
  wheels: {{node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, deadband: 0,
           fields: {{linear.x: 0}}}}
connections:
  - scan -> encoder [1] -> {spikes}decoder [1] -> wheels [1]
"""
MAPPING = {"message_type": "Twist", "mapping": {"linear.x": 0}}


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Roscore:
    """A ROS master on a free port for the length of a `with` block."""

    def __enter__(self):
        port = free_port()
        self.environment = dict(os.environ, ROS_MASTER_URI=f"http://127.0.0.1:{port}",
                                ROS_IP="127.0.0.1")
        self.process = subprocess.Popen(["roscore", "-p", str(port)], env=self.environment,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                        start_new_session=True)
        for _ in range(200):
            with socket.socket() as probe:
                if probe.connect_ex(("127.0.0.1", port)) == 0:
                    time.sleep(0.5)
                    return self
            time.sleep(0.1)
        raise SystemExit("roscore did not start within 20 s")

    def __exit__(self, *_):
        os.killpg(self.process.pid, signal.SIGINT)
        self.process.wait(10)


def write_job(folder, tick_ms, network):
    spikes = ("encoder.out -> network.in [1]\nnetwork.out -> decoder.in [1]" if network
              else "encoder.out -> decoder.in [1]")
    text = JOB.format(tick_s=tick_ms / 1000, network=NETWORK if network else "", spikes=spikes)
    (folder / "job.music").write_text(text)
    (folder / "job.yaml").write_text(EXPERIMENT.format(
        tick_ms=tick_ms, spikes="brain [1] -> " if network else "",
        network="  brain: {simulator: builtin, network: network.yaml}\n" if network else ""))
    (folder / "mapping.json").write_text(json.dumps(MAPPING))
    (folder / "network.yaml").write_text(REPEATER)


def measure(programs, roscore, layout, tick_ms, trials, network):
    """One row: the probe's figures and the command adapter's own."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_job(folder, tick_ms, network)
        arguments = ["job.yaml", "--no-record"] if layout == "fused" else ["job.music"]
        job = subprocess.Popen([programs / "spikeloop", "run", *arguments, "--quiet", "--out", "out"],
                               cwd=folder, env=roscore.environment)
        try:
            probe = subprocess.run([programs.parent / "benchmarks/bin/latency_probe", "--trials",
                                    str(trials)], env=roscore.environment, capture_output=True,
                                   text=True, timeout=60 + 2 * trials)
        finally:
            job.send_signal(signal.SIGINT)
            job.wait(20)
        if probe.returncode != 0:
            raise SystemExit(f"latency_probe failed at {tick_ms} ms: {probe.stderr.strip()}")
        row = json.loads(probe.stdout)
        summary = json.loads((folder / "out/summary.json").read_text())
    row.update(layout=layout, tick_ms=tick_ms, network=network, inside_median_ms=summary.get("latency_median_ms"))
    return row


def print_table(rows):
    print(f"{'layout':<9}{'tick':>8} {'network':>8} {'answered':>9} {'median':>9} {'p90':>9} {'p99':>9} "
          f"{'max':>9} {'inside':>14} {'ROS':>9}")
    for row in rows:
        inside = row["inside_median_ms"]
        ros = None if inside is None else row["median_ms"] - inside
        print(f"{row['layout']:<9}{row['tick_ms']:>5g} ms {'yes' if row['network'] else 'no':>8} "
              f"{row['answered']:>5}/{row['trials']:<3} " +
              " ".join(f"{row[key]:>6.2f} ms" for key in
                       ("median_ms", "p90_ms", "p99_ms", "max_ms")) +
              (f" {inside:>11.2f} ms {ros:>6.2f} ms" if inside is not None else ""))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ticks", default="1,10,50", help="ms, divided by commas")
    parser.add_argument("--trials", type=int, default=100)
    parser.add_argument("--layouts", default="separate,fused", help="divided by commas")
    parser.add_argument("--network", action="store_true", help="also with the built-in network")
    parser.add_argument("--build", default=ROOT / "build/release", type=pathlib.Path)
    parser.add_argument("--json", type=pathlib.Path, help="write the rows to this file")
    options = parser.parse_args()
    rows = []
    with Roscore() as roscore:
        for network in ([False, True] if options.network else [False]):
            for tick in (float(text) for text in options.ticks.split(",")):
                for layout in options.layouts.split(","):
                    rows.append(measure(options.build.resolve() / "bin", roscore, layout, tick,
                                        options.trials, network))
                    print(f"measured: {layout}, tick {tick:g} ms", file=sys.stderr)
    print_table(rows)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
