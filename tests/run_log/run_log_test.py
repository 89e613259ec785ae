#!/usr/bin/python3
"""log.txt has what a run said, also when it was killed; versions are those of the packages."""

import datetime
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from calls import SPIKELOOP, spikeloop  # noqa: E402
from growing_file import complete_text  # noqa: E402

LINE = re.compile(r"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3})Z +(\d+\.\d{3}) s  (.*)")
SMALL = """experiment: small
duration: {duration}
sync: {sync}
robot: {{simulator: mujoco}}
{more}nodes:
  scan: {{node: ros_sensor, topic: /odom, message: nav_msgs/Odometry}}
  cells: {{node: rate_encoder, rate_max: 50 Hz}}
  window: {{node: rate_window, window: 50 ms}}
connections:
  - scan -> cells [2] -> window [2]
"""
DEAF = """  deaf: {node: ros_sensor, topic: /nobody, message: std_msgs/Float64MultiArray}
  low: {node: low_pass, tau: 20 ms}
"""
FAILING = """import spikeloop
ticks = 0
@spikeloop.node(inputs={"in": "signal"}, outputs={"out": spikeloop.Signal(same_as="in")})
def failing(step):
    global ticks
    ticks += 1
    if ticks > 500:
        raise ValueError("that was enough")
"""


def small(duration, sync="lockstep", more=""):
    return SMALL.format(duration=duration, sync=sync, more=more)


def log_of(folder):
    """Pairs of simulated time and text; every line has both times."""
    lines = []
    before = None
    for line in complete_text(folder / "log.txt").splitlines():
        match = LINE.fullmatch(line)
        assert match, line
        now = datetime.datetime.fromisoformat(match[1])
        assert before is None or now >= before, line
        before = now
        lines.append((float(match[2]), match[3]))
    age = datetime.datetime.now(datetime.timezone.utc).replace(tzinfo=None) - before
    assert datetime.timedelta(0) <= age < datetime.timedelta(minutes=2), age
    return lines


def a_quiet_run(folder):
    """-q keeps nothing out of the log; a second run begins a new one."""
    file = folder / "small.yaml"
    file.write_text(small(duration="2 s"))
    for _ in range(2):
        spikeloop("run", "-q", file, "--out", folder / "quiet", "--force")
        lines = log_of(folder / "quiet")
        assert len(lines) == 2, lines
        assert lines[0][1].endswith("small.yaml, layout fused, sync lockstep, seed 1"), lines
        assert lines[1] == (2.0, "finished: 2.0 of 2 s"), lines


def a_node_that_fails(folder):
    (folder / "failing.py").write_text(FAILING)
    file = folder / "failing.yaml"
    text = small(duration="2 s", more="plugins: [failing.py]\n")
    file.write_text(text.replace("-> window [2]", "-> window [2] -> bad [2]")
                    .replace("connections:", "  bad: {node: failing}\nconnections:"))
    spikeloop("run", file, "--out", folder / "failing", code=5)
    at, last = log_of(folder / "failing")[-1]
    assert at == 0.5, at
    assert "that was enough" in last and last.endswith("exit code 5"), last
    versions = json.loads((folder / "failing" / "resolved.json").read_text())["versions"]
    python = subprocess.run(["/usr/bin/python3", "-c", "import platform, numpy; "
                             "print(platform.python_version(), numpy.__version__)"],
                            capture_output=True, text=True, check=True).stdout.split()
    assert [versions["python"], versions["numpy"]] == python, versions


def a_run_that_cannot_begin(folder):
    file = folder / "blocked.yaml"
    file.write_text(small(duration="1 s"))
    (folder / "blocked" / "scan.h5").mkdir(parents=True)  # where a recording is to be
    spikeloop("run", file, "--out", folder / "blocked", code=4)
    last = log_of(folder / "blocked")[-1][1]
    assert "scan.h5" in last and last.endswith("exit code 4"), last


def a_killed_run(folder):
    file = folder / "long.yaml"
    file.write_text(small(duration="60 s", sync="realtime"))
    out = folder / "killed"
    with subprocess.Popen([SPIKELOOP, "run", "-q", file, "--out", out]) as process:
        deadline = time.monotonic() + 30
        while not complete_text(out / "log.txt"):
            assert time.monotonic() < deadline, "no log"
            time.sleep(0.02)
        os.kill(process.pid, signal.SIGKILL)
    assert log_of(out)[0][1].endswith("layout fused, sync realtime, seed 1")


def installed(package):
    version = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", package],
                             capture_output=True, text=True, check=True).stdout
    return re.match(r"(?:\d+:)?([0-9.]*\d)", version)[1]


def latency_is_recorded(folder):
    """A row a message; median and percentile are those that the command counted itself."""
    summary = json.loads((folder / "summary.json").read_text())
    with h5py.File(folder / "wheels.h5") as file:
        values = np.sort(file["signals/latency/values"][:, 0])
    assert summary["latency_clock"] == "wall", summary
    assert 5 <= len(values) <= summary["scans"], (len(values), summary["scans"])
    ranks = [values[int(np.ceil(part * len(values))) - 1] for part in (0.5, 0.99)]
    counted = [summary["latency_median_ms"], summary["latency_p99_ms"]]
    assert np.allclose(ranks, counted, rtol=1e-12, atol=0), (ranks, counted)


def versions_are_those_of_the_packages(folder):
    drive = spikeloop("new")[0].replace("robot: {", "ros: 1\nrobot: {")
    # Nobody publishes what a second sensor listens to: that is said, also with -q.
    deaf = drive.replace("nodes:\n", "nodes:\n" + DEAF) + "  - deaf -> low [2]\n"
    expected = {"hdf5": installed("libhdf5-103-1"), "mujoco": installed("libmujoco2.2.2"),
                "roscpp": installed("libroscpp4d")}
    parallel = {"music": installed("music-bin"), "mpi": installed("openmpi-bin")}
    for layout, wanted in (("fused", expected), ("separate", {**expected, **parallel})):
        out = folder / layout
        (folder / "ros.yaml").write_text(deaf if layout == "fused" else drive)
        spikeloop("run", "-q", folder / "ros.yaml", "--layout", layout, "--duration", "3", "--out",
            out)
        resolved = json.loads((out / "resolved.json").read_text())
        versions = resolved["versions"]
        assert {key: versions.get(key) for key in wanted} == wanted, versions
        assert layout == "separate" or "music" not in versions, versions
        assert resolved["ros"] == "1" and resolved["machine"]["kernel"] == \
            f"{os.uname().sysname} {os.uname().release}", resolved["machine"]
        latency_is_recorded(out)
        lines = log_of(out)
        assert any(text.startswith("ROS master at ") for _, text in lines), lines
        assert layout != "fused" or any("warning: " in text and "'/nobody'" in text for _, text in lines), lines
        assert lines[-1][1].startswith("finished: 3.0 of 3 s"), lines
    job = folder / "separate" / "effective.music"
    assert job.exists()
    (folder / "pair.music").write_text(
        f"stoptime=0.1\nsync=unpaced\n[a]\nnp=1\nbinary=signal_playback\n"
        f"file={folder}/fused/sectors.h5\n[b]\nnp=1\nbinary=rate_encoder\n"
        "[c]\nnp=1\nbinary=spikeloop-node\nnode=rate_window\na.out->b.in[10]\nb.out->c.in[10]\n")
    spikeloop("run", folder / "pair.music", "--out", folder / "pair")
    about = json.loads((folder / "pair" / "versions.json").read_text())
    assert {key: about["versions"].get(key) for key in parallel} == parallel, about
    assert "roscpp" not in about["versions"] and about["machine"]["cores"] >= 1, about


def main():
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        a_quiet_run(folder)
        a_node_that_fails(folder)
        a_run_that_cannot_begin(folder)
        a_killed_run(folder)
        versions_are_those_of_the_packages(folder)


if __name__ == "__main__":
    main()
