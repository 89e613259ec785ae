"""The schema is one, right files pass it, and wrong ones do not:  check_schema.py SPIKELOOP"""
import json
import subprocess
import sys

import jsonschema
import yaml

GOOD = """
experiment: table
duration: 1 s
robot: {simulator: mujoco, seed: 3}
episodes: {count: 2, reset: all}
nodes:
  scan: {node: ros_sensor, topic: /scan, message: LaserScan, initial: 0}
  odom: {node: ros_sensor, topic: /odom, message: Odometry, fields: [pose.pose.position.x]}
  encoder: {node: rate_encoder, rate_max: 0.2 kHz, rate_min: 0}
  brain: {simulator: builtin, network: net.yaml}
  cells: {simulator: neuron, script: brain.py, weight: 0.05, gains: [1, 2], record: false}
  other: {node: network, network: {populations: {n: {model: repeater, size: 3}}, output: [n]}}
  decoder: {node: linear_readout, tau: 30 ms, weights: [[1, 0, 0.5], [0, 1, -2]]}
  sparse: {node: connect, weights: {rows: 1, columns: 3, entries: [[0, 2, 0.5]]}}
  places: {node: discretize, grid: {axes: [[-1, 1, 5, 0.2]]}}
  smooth: {node: sigmoid, slope: 1e-1, record: true}
  wheels:
    node: ros_command
    topic: /cmd_vel
    message: Twist
    fields: {linear.x: 0, angular.z: {channel: 1, offset: -0.2}}
    limits: {linear.x: [-1, 1]}
connections:
  - scan -> encoder [3] -> brain.in [ 3, delay 2 ticks ] -> decoder -> wheels [2]
  - {from: odom.out, to: smooth, width: 1, delay: 1.5 ms}
  - scan, odom.out, scan -> first [3] -> second
  - scan + odom -> third
  - scan[0:50], odom.out[7] -> sixth
  - scan[:5] + scan[5:] -> seventh [5]
  - {from: [scan, "odom.out[0:2]"], to: fourth}
  - {from: scan + odom, to: fifth}
ros: 1
"""

# What to write instead of a part of it.
WRONG = [
    ("duration", "durations"),
    ("1 s\n", "1\n"),
    ("1 s\n", "1 Hz\n"),
    ("1 s\n", "-1 s\n"),
    ("ros: 1", "ros: 3"),
    ("ros: 1", "sync: fast"),
    ("ros: 1", "seed: -1"),
    ("ros: 1", "seed: one"),
    ("ros: 1", "real_time_factor: 0"),
    ("ros: 1", "plugins: mine.so"),
    ("mujoco", "gazebo"),
    ("seed: 3", "sede: 3"),
    ("node: rate_encoder", "node: rate_encodr"),
    ("node: rate_encoder, ", ""),
    ("simulator: builtin", "simulator: builtin, node: network"),
    ("simulator: builtin", "simulator: nest"),
    ("simulator: neuron", "simulator: nueron"),
    ("script: brain.py, ", ""),
    ("script: brain.py", "script: brain.py, np: 0"),
    ("topic: /scan, ", ""),
    ("topic: /scan", "tpoic: /scan"),
    ("rate_max: 0.2 kHz", "rate_max: 200"),
    ("rate_max: 0.2 kHz", "rate_max: 200 mV"),
    ("rate_max: 0.2 kHz", "rate_max: fast"),
    ("rate_max: 0.2 kHz", "rate_max: -3 Hz"),
    ("rate_max: 0.2 kHz", "rate_max: [200 Hz]"),
    ("rate_max: 0.2 kHz", "out_of_range: clop"),
    ("[0, 1, -2]", "[0, x, 1]"),
    ("entries:", "entrys:"),
    ("axes: [[-1, 1, 5, 0.2]]", "axes: [[-1, 1, 5]]"),
    ("linear.x: 0,", "linear.x: {chanel: 0},"),
    ("linear.x: 0,", "linear.x: -1,"),
    ("limits: {linear.x: [-1, 1]}", "limits: {linear.x: 1}"),
    ("record: true", "record: maybe"),
    ("record: false", "record: maybe"),
    ("output: [n]", "outputs: [n]"),
    ("  smooth:", "  smo-oth:"),
    ("scan -> encoder [3]", "scan => encoder [3]"),
    ("scan -> encoder [3]", "scan [3] -> encoder"),
    ("scan, odom.out, scan", "scan, odom.out + scan"),
    ("scan, odom.out, scan", "scan, odom.out,"),
    ('[scan, "odom.out[0:2]"]', "[]"),
    ('[scan, "odom.out[0:2]"]', "[scan + odom]"),
    ("scan[0:50]", "scan[0-50]"),
    ("scan[0:50]", "scan[0:50:2]"),
    ("scan[:5]", "scan[:]"),
    ("width: 1", "width: 0"),
    ("to: smooth", "too: smooth"),
    ("delay: 1.5 ms", "delay: 1.5"),
]


def main():
    def printed(*arguments):
        return subprocess.run([sys.argv[1], *arguments], check=True, capture_output=True,
                              text=True).stdout

    schema = json.loads(printed("schema"))
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    for text in (GOOD, printed("new")):
        validator.validate(yaml.safe_load(text))
    missed = []
    for part, other in WRONG:
        assert part in GOOD, part
        if validator.is_valid(yaml.safe_load(GOOD.replace(part, other, 1))):
            missed.append(f"{part!r} -> {other!r}")
    for holder in ("nodes", "connections"):
        data = yaml.safe_load(GOOD)
        del data[holder]
        if validator.is_valid(data):
            missed.append(f"no {holder}")
    print("\n".join(missed) if missed else f"{len(WRONG) + 2} wrong files are seen")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
