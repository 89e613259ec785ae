#!/usr/bin/python3
"""A mistake has the same words and the same code in an experiment and in a .music file."""

import argparse
import json
import pathlib
import re
import subprocess
import tempfile

EXPERIMENT = """experiment: x
duration: 1 s
tick: {tick}
seed: {seed}
ros: 1
nodes:
  scan: {{node: ros_sensor, {scan}}}
  encoder: {{node: {encoder}}}
  decoder: {{node: linear_readout, {decoder}}}
  wheels: {{node: ros_command, {wheels}}}
connections:
{connections}
"""
MUSIC = """stoptime=1
music_timestep={tick}
seed={seed}
strict=true
[scan]
np=1
binary=ros_sensor_adapter
{scan}
[encoder]
np=1
{encoder}
[decoder]
np=1
binary=linear_readout_decoder
{decoder}
[wheels]
np=1
binary=ros_command_adapter
{wheels}
{connections}
"""
CHAIN = ("scan.out -> encoder.in [100]", "encoder.out -> decoder.in [100]",
         "decoder.out -> wheels.in [2]")
# What is right, in both languages.
RIGHT = {
    "tick": ("1 ms", "0.001"), "seed": ("1", "1"),
    "scan": ("topic: /scan, message: sensor_msgs/LaserScan",
             "ros_topic=/scan\nmessage_type=Laserscan"),
    "encoder": ("rate_encoder", "binary=rate_encoder"),
    "decoder": ("weights: uniform", "weights=uniform"),
    "wheels": ("topic: /cmd_vel, message: geometry_msgs/Twist, "
               "fields: {linear.x: 0, angular.z: 1}",
               "ros_topic=/cmd_vel\nmessage_mapping_filename=twist.json"),
    "connections": CHAIN,
}
FILES = {
    "twist.json": {"message_type": "Twist", "mapping": {"linear.x": 0, "angular.z": 1}},
    "channel.json": {"message_type": "Twist", "mapping": {"linear.x": 0, "angular.z": 5}},
    "field.json": {"message_type": "Twist", "mapping": {"linear.x": 0, "angular.q": 1}},
    "small.json": [[0.1, 0.2], [0.3, 0.4]],
}


def also(part, experiment, music):
    """A key more than what is right."""
    right = RIGHT[part]
    return (part, f"{right[0]}, {experiment}", f"{right[1]}\n{music}")


def instead(part, old, experiment, music):
    """With another value of a key: `old` are the two right ones."""
    right = RIGHT[part]
    assert old[0] in right[0] and old[1] in right[1]
    return (part, right[0].replace(old[0], experiment), right[1].replace(old[1], music))


def linked(*connections):
    return ("connections", connections, connections)


TOPIC = ("topic: /scan", "ros_topic=/scan")
TYPE = ("message: sensor_msgs/LaserScan", "message_type=Laserscan")
WEIGHTS = ("weights: uniform", "weights=uniform")
FIELDS = ("linear.x: 0, angular.z: 1", "twist.json")

# What stands in the message of both, and the mistake.
MISTAKES = [
    ("unknown key 'rate_mx'; did you mean 'rate_max'?",
     also("encoder", "rate_mx: 200 Hz", "rate_mx=200")),
    ("'fast' is not a number", also("encoder", "rate_max: fast", "rate_max=fast")),
    ("'ms' is not a unit of frequency", also("encoder", "rate_max: 2 ms", "rate_max=2 ms")),
    ("-1 is out of bounds", also("encoder", "rate_max: -1 Hz", "rate_max=-1")),
    ("duplicate key 'rate_max'",
     also("encoder", "rate_max: 2 Hz, rate_max: 1 Hz", "rate_max=2\nrate_max=1")),
    ("unknown node class 'rate_encodr'; did you mean 'rate_encoder'?",
     ("encoder", "rate_encodr", "binary=spikeloop-node\nnode=rate_encodr")),
    ("0 is out of bounds", also("decoder", "tau: 0 ms", "tau=0")),
    ("'30 mV': 'mV' is not a unit of time", also("decoder", "tau: 30 mV", "tau=30 mV")),
    ("there is no weight file 'no.json'", instead("decoder", WEIGHTS, "weights: no.json",
                                                  "weights=no.json")),
    ("the weights have 2 rows and 2 columns", instead("decoder", WEIGHTS, "weights: small.json",
                                                      "weights=small.json")),
    ("one-to-one weights need ports of one width",
     instead("decoder", WEIGHTS, "weights: one_to_one", "weights=one_to_one")),
    ("not JSON", instead("decoder", WEIGHTS, "weights: bad.json", "weights=bad.json")),
    ("is missing", instead("scan", TOPIC, "initial: none", "initial=none")),
    ("'/a b' is not a valid ROS topic name", instead("scan", TOPIC, 'topic: "/a b"',
                                                 "ros_topic=/a b")),
    ("is missing", instead("scan", TYPE, "initial: none", "initial=none")),
    ("unknown message type 'LaserScam'; did you mean 'LaserScan'?",
     instead("scan", TYPE, "message: LaserScam", "message_type=LaserScam")),
    ("unknown message type 'my_msgs/Scan'",
     instead("scan", TYPE, "message: my_msgs/Scan", "message_type=my_msgs/Scan")),
    ("has no field 'rangs'; did you mean 'ranges'?",
     also("scan", "fields: [rangs]", "fields=rangs")),
    ("gives 2 values, but the port has 100 channels",
     also("scan", "fields: [range_min, range_max]", "fields=range_min,range_max")),
    ("'some' is neither a number nor 'none'", also("scan", "initial: some", "initial=some")),
    ("'fast' is not a number", also("wheels", "command_rate: fast", "command_rate=fast")),
    ("-1 is out of bounds", also("wheels", "command_rate: -1 Hz", "command_rate=-1")),
    ("-2 is out of bounds", also("wheels", "deadband: -2", "deadband=-2")),
    ("'soon' is not a number", also("wheels", "min_interval: soon", "min_interval=soon")),
    ("0 is out of bounds", also("wheels", "watchdog: 0 s", "watchdog=0")),
    ("'kg' is not a unit of time", also("wheels", "max_age: 1 kg", "max_age=1 kg")),
    ("/cmd_vel is the topic of the commands themselves",
     also("wheels", "emergency_stop: /cmd_vel", "emergency_stop=/cmd_vel")),
    ("'1stop' is not a valid ROS topic name",
     also("wheels", "emergency_stop: 1stop", "emergency_stop=1stop")),
    ("unknown message type 'Boole'; did you mean 'Bool'?",
     also("wheels", "emergency_stop: {message: Boole}", "emergency_stop_message=Boole")),
    ("has no field 'dat'; did you mean 'data'?",
     also("wheels", "emergency_stop: {field: dat}", "emergency_stop_field=dat")),
    ("'yes' is not a truth value",
     also("wheels", "emergency_stop: {latched: yes}", "emergency_stop_latched=yes")),
    ("'no' is not a truth value",
     also("wheels", "emergency_stop: {required: no}", "emergency_stop_required=no")),
    ("-1 is out of bounds",
     also("wheels", "emergency_stop: {timeout: -1 s}", "emergency_stop_timeout=-1")),
    ("/cmd_vel is the topic of the commands themselves",
     also("wheels", "override: /cmd_vel", "override=/cmd_vel")),
    ("/emergency_stop is the topic of the emergency stop",
     also("wheels", "override: /emergency_stop", "override=/emergency_stop")),
    ("'/a b' is not a valid ROS topic name", also("wheels", 'override: "/a b"', "override=/a b")),
    ("0 is out of bounds", also("wheels", "override: {timeout: 0 s}", "override_timeout=0")),
    ("reads channel 5, but the port has 2",
     instead("wheels", FIELDS, "linear.x: 0, angular.z: 5", "channel.json")),
    ("has no field 'q'", instead("wheels", FIELDS, "linear.x: 0, angular.q: 1", "field.json")),
    ("unknown node 'encodr'; did you mean 'encoder'?",
     linked("scan.out -> encodr.in [100]", *CHAIN[1:])),
    ("'encoder' has no input port 'inn'; did you mean 'in'?",
     linked("scan.out -> encoder.inn [100]", *CHAIN[1:])),
    ("'decoder' has no output port 'spikes'",
     linked(*CHAIN[:2], "decoder.spikes -> wheels.in [2]")),
    ("continuous output 'scan.out' cannot drive spike input 'decoder.in'",
     linked("scan.out -> encoder.in [100]", "scan.out -> decoder.in [100]", CHAIN[2])),
    ("spike output 'encoder.out' cannot drive continuous input 'wheels.in'",
     linked(*CHAIN[:2], "encoder.out -> wheels.in [100]")),
    ("input 'encoder.in' has two senders, 'scan.out' and 'decoder.out'",
     linked(*CHAIN, "decoder.out -> encoder.in [100]")),
    ("the connection 'scan.out -> encoder.in' is written twice", linked(CHAIN[0], *CHAIN)),
    ("input 'decoder.in' is not connected", linked(CHAIN[0], CHAIN[2])),
    ("port 'encoder.out' has 90 channels but must have 100, as many as 'encoder.in'",
     linked(CHAIN[0], "encoder.out -> decoder.in [90]", CHAIN[2])),
    ("0 is out of bounds; write a value from 1e-09 to 1000 s", ("tick", "0 s", "0")),
    ("'Hz' is not a unit of time", ("tick", "1 Hz", "1 Hz")),
    ("-1 is out of bounds", ("seed", "-1", "-1")),
    ("'one' is not a whole number", ("seed", "one", "one")),
]
# Spellings of one thing, the same part of a map, and what belongs to one language alone.
SPELLINGS = [(r"^\S+?:\d+:\d+: ", ""), (r"^node '\w+': ", ""), (r"\bros_topic\b", "topic"),
             (r"\bmessage_type\b", "message"), (r"\bmusic_timestep\b", "tick"),
             (r"(\w)=(\S)", r"\1: \2"), (r"'(emergency_stop|override)': key '", r"'\1_"),
             (r"'fields\.", "'mapping."), (r"\S+/bad.json|\bbad.json", "bad.json"),
             (r"(; the first is at |; known: ).*?( \[SL|$)", r"\2")]


def said(spikeloop, folder, name, text):
    """Every error of a file, without its place."""
    (folder / name).write_text(text)
    run = subprocess.run([spikeloop, "check", name], cwd=folder, capture_output=True, text=True)
    assert run.returncode == 2, (run.returncode, run.stderr, text)
    errors = re.findall("^error: (.*)", run.stderr, re.MULTILINE)
    for pattern, better in SPELLINGS * 2:
        errors = [re.sub(pattern, better, re.sub(r"^\w+: (?=/)", "", error)) for error in errors]
    return errors


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--spikeloop", required=True)
    spikeloop = parser.parse_args().spikeloop
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for name, content in FILES.items():
            (folder / name).write_text(json.dumps(content))
        (folder / "bad.json").write_text("[[1,2")
        wrong = 0
        for words, (part, experiment, music) in MISTAKES:
            parts = [{**{name: both[i] if name != "connections" else both
                         for name, both in RIGHT.items()}, part: mistake}
                     for i, mistake in enumerate((experiment, music))]
            for values, line in zip(parts, ("  - {}", "{}")):
                values["connections"] = "\n".join(map(line.format, values["connections"]))
            ours = said(spikeloop, folder, "x.yaml", EXPERIMENT.format(**parts[0]))
            theirs = said(spikeloop, folder, "x.music", MUSIC.format(**parts[1]))
            common = [text for text in ours
                      if text in theirs and words in text and re.search(r" \[SL\d{4}\]$", text)]
            if not common:
                wrong += 1
                print(f"{words}\n  experiment: {ours}\n  .music:     {theirs}")
        assert wrong == 0, f"{wrong} of {len(MISTAKES)} mistakes have different words"
        print(f"{len(MISTAKES)} mistakes: the same words in both languages")


if __name__ == "__main__":
    main()
