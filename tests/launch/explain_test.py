#!/usr/bin/python3
"""Every code is explained, and its example is one: the wrong line gives the code, the right line none."""

import argparse
import os
import pathlib
import re
import subprocess
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
EXPERIMENT = """experiment: loop
duration: 1 s
tick: 1 ms
seed: 1
sync: lockstep
robot: {simulator: mujoco, world: arena.xml}
nodes:
  scan: {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}
  encoder: {node: rate_encoder, rate_max: 200 Hz}
  readout: {node: linear_readout, weights: uniform}
  wheels: {node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, fields: {linear.x: 0, angular.z: 1}}
connections:
  - scan -> encoder [100]
  - encoder -> readout [100]
  - readout -> wheels [2]
"""
# What no single line of an experiment shows: the lines that change, files beside it, the environment.
OTHERS = {
    "SL0309": (["readout: {node: linear_readout, weights: bad.npy}"], {"bad.npy": "no array"}, {}),
    "SL0402": (["plugins: [bad.so]"], {"bad.so": "no library"}, {}),
    "SL0404": (["encoder: {simulator: python, script: empty.py}"], {"empty.py": "pass\n"}, {}),
    "SL0405": (["encoder: {simulator: builtin, network: net.yaml}"], {"net.yaml": """
populations:
  input: {model: input, size: 100}
connections: []
output: [input]
"""}, {}),
    "SL0503": (["scan: {node: ros_sensor, topic: /scan, message: my/msg/Bad.msg, fields: [x]}"],
               {"my/msg/Bad.msg": "float64\n"}, {}),
    "SL0510": (["ros: 2", "sync: realtime"], {}, {"ROS_DOMAIN_ID": "many"}),
    "SL0801": (["robot: {simulator: mujoco, world: empty.xml}"], {"empty.xml": "<mujoco/>"}, {}),
    "SL0704": (["encoder: {node: function, function: sqrt(x0 - 1000), not_finite: error}"], {}, {}),
}
# With these lines as well, the function of a node has its ports.
FUNCTION = ["readout: {node: threshold}", "- encoder -> readout [1]", "- readout -> wheels [1]",
            "wheels: {node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, fields: {linear.x: 0}}"]
# While a run goes on, and of .music files and their programs: tests of the launcher and of ROS have these.
ELSEWHERE = {"SL0109", "SL0107", "SL0509", "SL0511", "SL0602", "SL0603", "SL0604", "SL0701", "SL0702", "SL0703"}


def with_lines(lines):
    """The experiment with each line in place of the one that begins alike, or at the top of the file."""
    text = EXPERIMENT
    for line in lines + (FUNCTION if "node: function" in lines[0] else []):
        start = re.match(r"(# )?(- \w+ ->|\w+:)", line).group(2)
        known = re.compile(rf"^( *){re.escape(start)}.*$", re.MULTILINE)
        text = (known.sub(lambda found: found.group(1) + line, text, count=1) if known.search(text)
                else f"{line}\n{text}")
    return text


def codes_of(spikeloop, folder, command, lines, files, environment):
    (folder / "x.yaml").write_text(with_lines(lines))
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(content)
    done = subprocess.run([spikeloop, command, "x.yaml"], cwd=folder, capture_output=True, text=True,
                          check=False, env={**os.environ, **environment})
    return re.findall(r"\[(SL\d{4})\]", done.stderr), done.stderr


def sections(page):
    for section in page.split("\n## ")[1:]:
        example = re.search(r"\nWrong:\n\n    (.*)\n\nRight:\n\n    (.*)\n", section, re.DOTALL)
        yield section[:6], example.groups() if example else None


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--spikeloop", required=True)
    spikeloop = parser.parse_args().spikeloop

    def printed(*arguments):
        return subprocess.run([spikeloop, "explain", *arguments], capture_output=True, text=True,
                              check=True).stdout

    page = printed("--markdown")
    assert page == (SOURCE / "docs/errors.md").read_text(), "spikeloop explain --markdown > docs/errors.md"
    header = (SOURCE / "core/include/spikeloop/core/code.hpp").read_text()
    declared = [f"SL{int(number):04}" for number in re.findall(r"^  \w+ = (\d+),", header, re.MULTILINE)]
    assert declared == [line[:6] for line in printed().splitlines()], "a code has no explanation"
    assert printed("sl103") == printed("SL0103"), "spelling of codes"
    wrong = []
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for code, example in sections(page):
            if code in ELSEWHERE:
                assert example is None, code
            elif example is None:
                command = "run" if code in ("SL0704", "SL0510") else "check"
                found, text = codes_of(spikeloop, folder, command, *OTHERS[code])
                if code not in found:
                    wrong.append(f"{code} is not printed:\n{text}")
            else:
                lines = [[line.strip()] for line in example]
                found, text = codes_of(spikeloop, folder, "check", lines[0], {}, {})
                if code not in found:
                    wrong.append(f"{code} is not printed for {lines[0]}:\n{text}")
                found, text = codes_of(spikeloop, folder, "check", lines[1], {}, {})
                if code in found:
                    wrong.append(f"the right example of {code} is wrong: {lines[1]}:\n{text}")
    assert not wrong, "\n".join(wrong)
    print(f"{len(declared)} codes, each with its explanation")


if __name__ == "__main__":
    main()
