"""The closed loop that the tests of this directory disturb, and the time limits of its stops."""

import os
import pathlib
import subprocess

PROGRAMS = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])
MARGIN_MS = 200
SENSOR_TIMEOUT_MS = 500
WATCHDOG_MS = 100

LAYOUTS = ("fused", "separate", "music")  # music: the job of `spikeloop export`, one program per node
SCRIPT = "{simulator: python, script: brain.py}"
NETWORK = """
    simulator: builtin
    network:
      populations:
        input: {model: input, size: WIDTH}
        relay: {model: repeater, size: WIDTH}
      connections:
        - {from: input, to: relay, rule: one_to_one, delay: 1 ms}
      output: [relay]"""
EXPERIMENT = f"""experiment: faults
nodes:
  scan: {{node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}}
  encoder: {{node: rate_encoder, rate_max: 200 Hz}}
  brain: BRAIN
  decoder: {{node: linear_readout, tau: 30 ms, weights: uniform}}
  wheels:
    node: ros_command
    topic: /cmd_vel
    message: geometry_msgs/Twist
    fields: {{linear.x: {{channel: 0, offset: 0.5}}}}
    limits: {{linear.x: [0.1, 0.8]}}
    sensor_timeout: {SENSOR_TIMEOUT_MS} ms
    watchdog: {WATCHDOG_MS} ms
connections:
  - scan -> encoder [WIDTH] -> brain.in [WIDTH]
  - brain.out -> decoder [WIDTH] -> wheels [1]
"""
BRAIN = """import spikeloop

with spikeloop.music(spikes_in={"in": WIDTH}, spikes_out={"out": WIDTH}) as host:
    for tick in host:
        times, channels = tick.spikes("in")
        tick.send("out", times, channels)
"""


def experiment(script, width=10):
    """The text of the experiment.
    @param script True if the network is a Python script, in a process of its own"""
    return EXPERIMENT.replace("BRAIN", SCRIPT if script else NETWORK).replace("WIDTH", str(width))


def write(folder, text, width=10):
    """Writes the experiment and its script. Returns the path of the experiment."""
    (folder / "faults.yaml").write_text(text)
    (folder / "brain.py").write_text(BRAIN.replace("WIDTH", str(width)))
    return folder / "faults.yaml"


def command(file, version, layout):
    """The words that run an experiment file over this version of ROS; without --out."""
    spikeloop = PROGRAMS / "spikeloop"
    if layout != "music":
        return [spikeloop, "run", file, "--ros", version, "--layout", layout]
    file.write_text(f"ros: {version}\n{file.read_text()}")
    job = file.with_name("job")
    subprocess.run([spikeloop, "export", file, "--out", job], check=True, capture_output=True)
    return [spikeloop, "run", job / "experiment.music"]
