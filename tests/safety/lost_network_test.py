#!/usr/bin/python3
"""A run and a robot end in time if ROS hangs: after the loss of the network (closing a Cyclone DDS domain waits for
its receive threads), and with a ROS master that hangs.
"""

import contextlib
import itertools
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

sys.path += [str(pathlib.Path(__file__).parents[1] / name) for name in ("fused", "ros2", "support")]
import jobs  # noqa: E402
import networks  # noqa: E402
import ros  # noqa: E402

PROGRAMS = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])
LONGEST_END_S = 5
THREAD_PER_SOCKET = "<Internal><MultipleReceiveThreads>true</MultipleReceiveThreads></Internal>"


def network(state):
    subprocess.run(["ip", "link", "set", "lo", state], check=True)


@contextlib.contextmanager
def no_network(cyclone=None):
    network("up")
    with ros.domain():
        if cyclone:
            os.environ["CYCLONEDDS_URI"] = cyclone
        yield "2", lambda: network("down")
    network("up")


@contextlib.contextmanager
def hanging_master(scratch):
    network("up")
    with ros.master(scratch) as uri:
        port = uri.rsplit(":", 1)[1]
        master = next(pid for pid in jobs.processes_of(os.getpid()) if port in pathlib.Path(
            f"/proc/{pid}/cmdline").read_text(encoding="utf-8").split("\0"))
        try:
            yield "1", lambda: os.kill(master, signal.SIGSTOP)
        finally:
            os.kill(master, signal.SIGCONT)


def end(process, number, expected, what, log):
    """Sends the signal, and asserts that the process ends in time with this exit code."""
    begin = time.monotonic()
    process.send_signal(number)
    try:
        code = process.wait(60)
    finally:
        process.kill()
    took = time.monotonic() - begin
    print(f"{what}, {signal.Signals(number).name}: exit code {code} after {took:.2f} s", flush=True)
    assert took < LONGEST_END_S, log.read_text(encoding="utf-8")
    assert code == expected, log.read_text(encoding="utf-8")


def start(words, log):
    with open(log, "w", encoding="utf-8") as out:
        return subprocess.Popen(words, stdout=out, stderr=out)


def check(place, what, number, options, scratch):
    with place as (version, lose):
        experiment, logs = scratch / "explorer.yaml", [scratch / "robot.log", scratch / "run.log"]
        with open(experiment, "w", encoding="utf-8") as file:
            subprocess.run([PROGRAMS / "spikeloop", "new"], stdout=file, check=True)
        robot = start([PROGRAMS / "spikeloop-robot", "--ros", version], logs[0])
        run = start([PROGRAMS / "spikeloop", "run", experiment, "--ros", version, "--set", "duration=1000 s",
                     *options, "--out", scratch / "run"], logs[1])
        try:
            ros.until(lambda: "overruns" in logs[1].read_text(encoding="utf-8"), "a tick", 90)
            family = jobs.processes_of(run.pid)
            lose()
            end(run, number, 128 + number, f"run, {what}", logs[1])
            assert not [pid for pid in family if pathlib.Path(f"/proc/{pid}").exists()], "processes are left"
            assert (scratch / "run/summary.json").exists()
            end(robot, signal.SIGTERM, 0, f"robot, {what}", logs[0])
        finally:
            for process in (run, robot):
                process.kill()
                process.wait()


def main():
    networks.enter()
    signals = itertools.cycle([signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGUSR1])
    for layout in (["--layout", "fused"], ["--layout", "separate"]):
        for made, what in ((lambda _: no_network(), "no network"),
                           (lambda _: no_network(THREAD_PER_SOCKET), "no network, a thread per socket"),
                           (hanging_master, "the master hangs")):
            with tempfile.TemporaryDirectory() as scratch:
                scratch = pathlib.Path(scratch)
                check(made(scratch), f"{what}, {layout[1]}", next(signals), layout, scratch)


if __name__ == "__main__":
    main()
