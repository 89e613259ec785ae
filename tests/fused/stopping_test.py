#!/usr/bin/python3
"""Ctrl-C, a node that fails, a folder in use, options of the other kind of file."""

import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

import runs

FAILING = """import spikeloop

@spikeloop.node(inputs={"in": "signal"}, outputs={"out": spikeloop.Signal(same_as="in")})
def failing(step):
    if step.begin > 100_000_000:
        raise ValueError("the battery is empty")
"""


def interrupted(spikeloop, scratch):
    file = runs.new_experiment(spikeloop, scratch / "long.yaml", duration="60 s")
    folder = scratch / "long"
    process = subprocess.Popen([spikeloop, "run", str(file), "--out", str(folder)],
                               stderr=subprocess.PIPE, text=True)
    while not (folder / "encoder.h5").exists():
        time.sleep(0.05)
    time.sleep(0.5)
    second = subprocess.run([spikeloop, "run", str(file), "--out", str(folder)],
                            capture_output=True, text=True, check=False)
    assert second.returncode == 4 and "another run that has not ended writes" in second.stderr, second
    process.send_signal(signal.SIGINT)
    _, printed = process.communicate(timeout=20)
    assert process.returncode == 130 and "stopped by SIGINT" in printed, printed
    summary = json.loads((folder / "summary.json").read_text())
    assert 0 < summary["simulated_s"] < 50, summary
    assert summary["counters"]["wheels.stops_ended"] == 1, summary


def failing_node(spikeloop, scratch):
    (scratch / "failing.py").write_text(FAILING)
    text = runs.new_experiment(spikeloop, scratch / "bad.yaml", sync="lockstep").read_text()
    text = text.replace("nodes:\n", "plugins: [failing.py]\nnodes:\n  odd: {node: failing}\n")
    text = text.replace("scan -> sectors", "scan -> odd [100] -> sectors")
    (scratch / "bad.yaml").write_text(text)
    summary, printed = runs.run(spikeloop, scratch / "bad.yaml", scratch / "bad", code=5)
    assert "node 'odd'" in printed and "ValueError: the battery is empty" in printed, printed
    assert summary["exit_code"] == 5 and "battery" in summary["exit_reason"], summary
    assert summary["counters"]["wheels.stops_terminated"] <= 1, summary


def wrong_options(spikeloop, scratch):
    file = runs.new_experiment(spikeloop, scratch / "options.yaml")
    for arguments, text in (
            (["--roscore"], "--roscore is for .music files, an experiment file says such things "
                            "itself; leave it out"),
            (["--layout", "separate"], "in the separate layout the robot is reached over ROS"),
            (["--sync", "locked"], "--sync")):
        done = subprocess.run([spikeloop, "run", str(file), *arguments], cwd=scratch,
                              capture_output=True, text=True, check=False)
        assert done.returncode == 2 and text in done.stderr, done
    music = scratch / "a.music"
    music.write_text("[a]\nnp=1\nbinary=b\n")
    done = subprocess.run([spikeloop, "run", str(music), "--no-record"], cwd=scratch,
                          capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "--no-record is for experiment files; leave it out" in done.stderr


def main():
    spikeloop = str(runs.programs() / "spikeloop")
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        interrupted(spikeloop, scratch)
        failing_node(spikeloop, scratch)
        wrong_options(spikeloop, scratch)
    print("stopped by Ctrl-C, by a failing node, and not begun with wrong options")


if __name__ == "__main__":
    sys.exit(main())
