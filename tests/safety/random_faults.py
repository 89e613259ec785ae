#!/usr/bin/python3
"""Runs an experiment again and again, each time with a random fault: a signal to a random process (the launcher,
mpirun, the guard, a program, the script) while the run starts, while the robot is driven, or while the run ends; in
every layout, over ROS 1 and ROS 2. The robot is not a part of Spikeloop, as in time_to_zero.py.

Each run must end in time and name the cause; leave no process and no file behind; and the last command that the robot
gets must be zero. A robot that is driven must stand within the time of docs/safety.md and 200 ms.

  random_faults.py --launches 1000 --seed 1

Nothing else may use /dev/shm meanwhile, or this script has one of its own (unshare -m). Over ROS 1 nothing else may
publish /cmd_vel on this machine, whatever its master: a subscriber of rospy tries again to reach publishers that were
killed, and takes another one that has the same port.
"""

import argparse
import os
import pathlib
import random
import signal
import statistics
import sys
import tempfile
import time

import loop
import robots
from faulty_run import FaultyRun, jobs
from loop import LAYOUTS, MARGIN_MS, PROGRAMS, WATCHDOG_MS

SIGNALS = ["KILL", "KILL", "TERM", "INT", "HUP", "QUIT", "SEGV", "ABRT", "STOP"]
PHASES = ["start", "driven", "driven", "end"]
START_S, STALL_S = 20, 4
STANDS_S = 0.5  # a robot counts as at rest after this time
LONGEST_S = START_S + STALL_S + 20  # mpirun has 10 s to end, and the launcher waits for the guard
GOES_ON_S = 1.5  # a robot that is still driven then belongs to a run that bears the fault


class Launch:
    """One run, one fault."""

    def __init__(self, dice, layout):
        self.layout = layout
        self.script = layout == "music" or dice.random() < 0.5
        self.phase = dice.choice(PHASES)
        self.signal = dice.choice(SIGNALS)
        self.moment_s = dice.uniform(0, {"start": 1.5, "driven": 0.5, "end": 0.3}[self.phase])
        self.dice = dice
        self.target, self.rest_ms, self.bound_ms, self.driven_on = "nothing", None, None, False

    def run(self, robot):
        with tempfile.TemporaryDirectory(prefix="faults-") as name:
            folder = pathlib.Path(name)
            words = loop.command(loop.write(folder, loop.experiment(self.script)), robot.version, self.layout)
            before = shared_files()
            robot.scans(True)
            started = time.monotonic()
            run = FaultyRun(robot, [*words, "--start-timeout", str(START_S), "--stall-timeout", str(STALL_S)], folder)
            try:
                self.strike(run)
                self.hung = not self.end(run)
            except AssertionError as error:  # it does not drive the robot
                print(error, run.printed(), sep="\n")
                self.hung = True
            finally:
                if self.signal == "STOP":  # a stopped guard ends when it is continued
                    jobs.send(run.processes(), signal.SIGCONT)
                self.left = run.left_behind()
                run.close()
            self.exit_code = run.exit_code()
            self.taken_s = time.monotonic() - started
            self.files = shared_files() - before
            lines = run.printed().replace("\r", "\n").splitlines()
            self.reason = ([line for line in lines if line.startswith("spikeloop: ")] or [""])[-1]
            self.last_command = robot.last()

    def strike(self, run):
        if self.phase != "start":
            run.await_driven(robots.Robot.is_driven)
        if self.phase == "end":
            run.send_ctrl_c()
        time.sleep(self.moment_s)
        candidates = run.find()
        if run.exit_code() is not None or not candidates:
            return
        pid, self.target = self.dice.choice(sorted(candidates.items()))
        if self.target == "launcher" and self.signal == "STOP":
            self.signal = "KILL"  # nobody else would end the run
        if self.target == "mpirun" and self.signal == "ABRT":
            self.signal = "KILL"  # mpirun passes that one on to the programs
        driven = self.phase == "driven" and run.robot.is_driven()
        begin = time.monotonic()
        jobs.send([pid], getattr(signal, f"SIG{self.signal}"))
        if driven:
            run.robot.time_to_zero_ms(begin, GOES_ON_S)
            time.sleep(STANDS_S)
            self.driven_on = run.robot.is_driven()
            if self.is_fatal() and not self.driven_on:
                self.rest_ms = run.robot.time_to_rest_ms(begin)
                self.bound_ms = MARGIN_MS + self.deadline_ms()

    def deadline_ms(self):
        """docs/safety.md."""
        if self.target in ("experiment", "wheels"):
            return WATCHDOG_MS + 100 if self.signal == "STOP" else 0
        if self.stops_supervision():
            return WATCHDOG_MS + 100
        return WATCHDOG_MS

    def end(self, run):
        """Whether the run ends in time; by Ctrl-C where it bears the fault."""
        deadline = time.monotonic() + LONGEST_S
        run.await_end(GOES_ON_S + STALL_S if self.signal == "STOP" else GOES_ON_S)
        while run.exit_code() is None and time.monotonic() < deadline:
            if run.robot.is_driven() or self.phase == "start" or self.stops_supervision():
                run.send_ctrl_c()
            run.await_end(5)
        return run.exit_code() is not None

    def complaints(self):
        late = self.rest_ms is not None and self.rest_ms > self.bound_ms
        # Helpers have no part in a run's reason; of a program that checks a section the launcher names the section.
        nameless = self.target not in ("mpirun", "experiment", "scan", "encoder", "brain", "decoder", "wheels")
        named = "" if nameless else self.target.replace("experiment", "spikeloop-fused")
        silent = self.exit_code not in (0, 130) and named not in self.reason and "its check ended" not in self.reason
        found = {
            "hung": self.hung,
            "ended by itself": self.target == "nothing" and self.phase != "end",
            f"left behind: {', '.join(self.left)}": self.left,
            f"left files {[str(file) for file in self.files]}": self.files,
            f"the last command is {self.last_command}": self.last_command not in (None, 0),
            "the robot was driven on": self.driven_on and self.is_fatal(),
            f"stood after {self.rest_ms or 0:.0f} ms instead of {self.bound_ms}": late,
            f"does not name {named}": silent}
        return [text for text, is_so in found.items() if is_so]

    def is_fatal(self):
        """A program of the loop, or the launcher, has gone or stands still, or nobody supervises the run."""
        return self.stops_supervision() or self.target not in ("guard", "supervisor", "cleaner", "mpirun", "nothing") and (
            self.signal in ("KILL", "SEGV", "ABRT", "QUIT", "STOP"))

    def stops_supervision(self):
        """The robot is at rest until the process is continued, or the run is ended."""
        return self.signal == "STOP" and self.target in ("mpirun", "supervisor")

    def __str__(self):
        stood = "" if self.rest_ms is None else f", stood after {self.rest_ms:.0f} ms"
        return (f"{self.layout}, {self.phase} + {self.moment_s:.2f} s, SIG{self.signal} to {self.target}: exit code "
                f"{self.exit_code} after {self.taken_s:.1f} s{stood}: {self.reason}")


def shared_files():
    return set(pathlib.Path("/dev/shm").iterdir())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--launches", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--ros", choices=["1", "2"], action="append")
    arguments = parser.parse_args()
    dice = random.Random(arguments.seed)
    launches = []
    versions = arguments.ros or ["1", "2"]
    for version in versions:
        with tempfile.TemporaryDirectory() as scratch, robots.robot(
                version, PROGRAMS, pathlib.Path(scratch)) as robot:
            for number in range(arguments.launches // len(versions)):
                launch = Launch(random.Random(dice.getrandbits(64)), LAYOUTS[number % 3])
                launch.run(robot)
                launches.append(launch)
                complaints = launch.complaints()
                print(f"{len(launches)}: ROS {version}, {launch}" + "".join(f"  <-- {text}" for text in complaints),
                      flush=True)
    bad = sum(launch.complaints() != [] for launch in launches)
    rests = [launch.rest_ms for launch in launches if launch.rest_ms is not None]
    print(f"{len(launches)} launches, {bad} with a complaint; the longest took "
          f"{max(launch.taken_s for launch in launches):.1f} s")
    if rests:
        print(f"{len(rests)} robots that were driven stood after {statistics.median(rests):.0f} ms (median), "
              f"{max(rests):.0f} ms at most")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
