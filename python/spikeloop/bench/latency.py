"""Part c: from a laser scan to the first command that follows it, over ROS.

One channel, a scan at 20 Hz that steps from minimum to maximum at random moments, a rate encoder up
to 1000 Hz, deadband 0. The same experiment in both layouts. A repeater of the built-in network may stand in between. The
command adapter's own measurement (message arrived to command computed) is the share of encoder and
MUSIC; the rest is ROS, and the time for which a command is held because the last one left less than
half a tick ago.
"""

import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import tempfile
import time

REPEATER = """resolution: 0.1 ms
populations:
  input: {model: input, size: 1}
  relay: {model: repeater, size: 1}
connections:
  - {from: input, to: relay, rule: one_to_one, weight: 1, delay: 0.1 ms}
output: [relay]
"""
EXPERIMENT = """experiment: latency
layout: {layout}
tick: {tick_ms:g} ms
ros: {ros}
nodes:
  scan: {{node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}}
  encoder: {{node: rate_encoder, rate_max: 1000 Hz}}
{network}  decoder: {{node: linear_readout, tau: 30 ms, weights: uniform}}
  wheels: {{node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, deadband: 0,
           fields: {{linear.x: 0}}, limits: none}}
connections:
  - scan -> encoder [1] -> {spikes}decoder [1] -> wheels [1]
"""
PROBE = "spikeloop-latency-probe"


class LatencyError(Exception):
    """Why nothing was measured."""


def lacks():
    """Why this part cannot be measured here; empty when it can."""
    return "" if shutil.which("rosmaster") else \
        "there is no rosmaster; apt-get install python3-rosmaster"


def reserved_port():
    """A socket at a free TCP port, which the kernel gives to no other program until it is closed. Programs
    that set SO_REUSEADDR, as rosmaster and ZeroMQ do, can listen there. spikeloop::ReservedPort in Python."""
    reserved = socket.socket()
    reserved.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    reserved.bind(("", 0))
    return reserved


class Domain:
    """A domain of ROS 2 for the length of a `with` block, on this machine alone."""

    version = 2

    def __enter__(self):
        self.environment = dict(os.environ, ROS_DOMAIN_ID=str(100 + os.getpid() % 100),
                                ROS_LOCALHOST_ONLY="1")
        return self

    def __exit__(self, *_):
        pass


class RosMaster:
    """A ROS master on a free port for the length of a `with` block."""

    version = 1

    def __enter__(self):
        self.reserved = reserved_port()
        port = self.reserved.getsockname()[1]
        self.environment = dict(os.environ, ROS_MASTER_URI=f"http://127.0.0.1:{port}",
                                ROS_IP="127.0.0.1")
        self.process = subprocess.Popen(["rosmaster", "--core", "-p", str(port)], env=self.environment,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                        start_new_session=True)
        try:
            for _ in range(200):
                with socket.socket() as probe:
                    if probe.connect_ex(("127.0.0.1", port)) == 0:
                        time.sleep(0.5)
                        return self
                time.sleep(0.1)
        except BaseException:
            self.__exit__()
            raise
        self.__exit__()
        raise LatencyError("rosmaster did not start within 20 s")

    def __exit__(self, *_):
        os.killpg(self.process.pid, signal.SIGINT)
        self.process.wait(10)
        self.reserved.close()


def write_experiment(folder, layout, ros, tick_ms, network):
    (folder / "job.yaml").write_text(EXPERIMENT.format(
        layout=layout, ros=ros, tick_ms=tick_ms, spikes="brain [1] -> " if network else "",
        network="  brain: {simulator: builtin, network: network.yaml}\n" if network else ""))
    (folder / "network.yaml").write_text(REPEATER)


def measure(programs, place, layout, tick_ms, trials, network, timeout_s=None):
    """One row: the probe's figures and the command adapter's own.

    place: a RosMaster or a Domain, where job and probe meet. Raises LatencyError.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_experiment(folder, layout, place.version, tick_ms, network)
        with open(folder / "said", "w", encoding="utf-8") as said:
            job = subprocess.Popen(
                [programs / "spikeloop", "run", "job.yaml", "--no-record", "--quiet", "--out", "out"],
                cwd=folder, env=place.environment, start_new_session=True,
                stdout=subprocess.DEVNULL, stderr=said)
        try:
            probe = subprocess.run([programs / PROBE, "--ros", str(place.version),
                                    "--trials", str(trials)],
                                   env=place.environment, capture_output=True, text=True,
                                   timeout=timeout_s or 60 + 2 * trials, check=False)
        except subprocess.TimeoutExpired as error:
            raise LatencyError(f"no end within {error.timeout:.0f} s") from None
        finally:
            job.send_signal(signal.SIGINT)
            job.wait(20)
        if probe.returncode != 0:
            last = (folder / "said").read_text().strip().splitlines()[-1:]
            raise LatencyError(f"{PROBE} failed at {tick_ms:g} ms: {probe.stderr.strip()}; the job: "
                               f"{last[0] if last else 'nothing'}")
        row = json.loads(probe.stdout)
        summary = json.loads((folder / "out/summary.json").read_text())
    row.update(ros=place.version, layout=layout, tick_ms=tick_ms, network=network,
               inside_median_ms=summary.get("latency_median_ms"))
    return row


def keys_of(row):
    return {key: row[key] for key in ("layout", "tick_ms", "network")}


def part_c(programs, plan, results, say, deadline_in):
    """Measures what results do not have. deadline_in(): seconds that are left."""
    wanted = [{"layout": layout, "tick_ms": tick_ms, "network": False}
              for layout in plan.layouts for tick_ms in plan.ticks_ms]
    known = [] if plan.again else [keys_of(row) for row in results.latencies
                                   if row["trials"] >= plan.steps]
    wanted = [keys for keys in wanted if keys not in known]
    for keys in wanted:
        results.settle(keys)
    if not wanted:
        return
    if reason := lacks():
        for keys in wanted:
            results.lacks(keys, reason, False)
        return
    with RosMaster() as master:
        for keys in wanted:
            left = deadline_in()
            if left < 5:
                results.lacks(keys, "out of time", False)
                continue
            say(f"{keys['layout']}, tick {keys['tick_ms']:g} ms: latency of {plan.steps} steps")
            try:
                row = measure(programs, master, keys["layout"], keys["tick_ms"], plan.steps, False,
                              min(left, 60 + 2 * plan.steps))
            except LatencyError as error:
                results.lacks(keys, str(error))
            else:
                results.add_latency(keys, row)


def table(rows):
    """The lines of a table."""
    yield (f"{'ROS':<4}{'layout':<9}{'tick':>8} {'network':>8} {'answered':>9} {'median':>9} {'p90':>9} "
           f"{'p99':>9} {'max':>9} {'inside':>14} {'rest':>9}")
    for row in rows:
        inside = row["inside_median_ms"]
        rest = None if inside is None else row["median_ms"] - inside
        yield (f"{row['ros']:<4}{row['layout']:<9}{row['tick_ms']:>5g} ms {'yes' if row['network'] else 'no':>8} "
               f"{row['answered']:>5}/{row['trials']:<3} " +
               " ".join(f"{row[key]:>6.2f} ms" for key in
                        ("median_ms", "p90_ms", "p99_ms", "max_ms")) +
               (f" {inside:>11.2f} ms {rest:>6.2f} ms" if inside is not None else ""))
