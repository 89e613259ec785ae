#!/usr/bin/python3
"""A stopped robot gets zero commands again and again, so that no lost message and no late subscriber matters: after
SIGSTOP and SIGCONT of the command's process until it is driven again, and while the loop waits for a simulator that
hangs.
"""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

import loop
import robots
from robots import ros

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
import jobs  # noqa: E402

PAUSE_S = 1.5  # no command after SIGCONT
LONGEST_GAP_S = 0.4  # a busy machine may delay a zero
PERIOD_S = 0.05


def longest_gap(robot, begin, end):
    """The longest time without a command; all are zeros."""
    heard = [(at, value) for at, value in list(robot.heard) if begin < at < end]
    assert not any(value for _, value in heard), heard
    times = [begin, *(at for at, _ in heard), end]
    assert len(heard) > (end - begin) / PERIOD_S / 2, heard
    return max(later - earlier for earlier, later in zip(times, times[1:])), len(heard)


def after_a_continue(robot, launcher):
    pid = jobs.find(launcher, "spikeloop-fused", None)
    os.kill(pid, signal.SIGSTOP)
    time.sleep(1)  # the guard has sent its zeros
    begin = time.monotonic()
    os.kill(pid, signal.SIGCONT)
    time.sleep(PAUSE_S - 0.05)
    gap, count = longest_gap(robot, begin, begin + PAUSE_S - 0.05)
    print(f"after SIGCONT: {count} zeros, longest gap {1e3 * gap:.0f} ms", flush=True)
    assert gap < LONGEST_GAP_S
    ros.until(robot.is_driven, "a command")


def while_the_simulator_hangs(robot, launcher):
    pid = jobs.find(launcher, "brain.py", None)
    os.kill(pid, signal.SIGSTOP)
    time.sleep(0.5)  # the watchdog has stopped the robot
    begin = time.monotonic()
    time.sleep(2)
    gap, count = longest_gap(robot, begin, begin + 2)
    print(f"while the simulator hangs: {count} zeros, longest gap {1e3 * gap:.0f} ms", flush=True)
    assert gap < LONGEST_GAP_S
    os.kill(pid, signal.SIGCONT)
    ros.until(robot.is_driven, "a command")


def main(version):
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        with robots.robot(version, loop.PROGRAMS, scratch) as robot:
            robot.scans(True)
            words = loop.command(loop.write(scratch, loop.experiment(script=True)), version, "fused")
            launcher = subprocess.Popen([*words, "--out", scratch / "run"], start_new_session=True)
            try:
                for fault in (after_a_continue, while_the_simulator_hangs):
                    ros.until(robot.is_driven, "a command", 90)
                    fault(robot, launcher.pid)
            finally:
                for pid in jobs.processes_of(launcher.pid):
                    os.kill(pid, signal.SIGCONT)
                os.killpg(launcher.pid, signal.SIGINT)
                launcher.wait(30)


if __name__ == "__main__":
    main(sys.argv[1])
