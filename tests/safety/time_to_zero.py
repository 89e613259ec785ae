#!/usr/bin/python3
"""From a fault to the zero command, as a subscriber of /cmd_vel sees it that is not a part of Spikeloop: rospy
over ROS 1, Fast DDS over ROS 2.

Scans come from it at 50 Hz; a script stands in the simulator's place; the command's timeouts are
declared. Every fault is made as often as asked for: those that the run survives one after the other in one
run, the others in a run each. A table in Markdown is printed. With --check a late one is made twice again; it
is an error when the median takes longer than the timeout that governs it and 200 ms.
"""

import argparse
import contextlib
import os
import pathlib
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import typing

import robots
from robots import ros

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
import jobs  # noqa: E402

PROGRAMS = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])
MARGIN_MS = 200
SENSOR_TIMEOUT_MS = 500
WATCHDOG_MS = 100
STANDS_S = 0.5  # that a robot stands is seen by then
IN_FLIGHT_S = 0.1  # what was sent has come

LAYOUTS = ("fused", "music", "processes")  # music: the job of `spikeloop export`, a program a node
EXPERIMENT = f"""experiment: faults
layout: {{vision: [scan, encoder], control: [decoder, wheels]}}
nodes:
  scan: {{node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}}
  encoder: {{node: rate_encoder, rate_max: 200 Hz}}
  brain: {{simulator: python, script: brain.py}}
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
  - scan -> encoder [10] -> brain.in [10]
  - brain.out -> decoder [10] -> wheels [1]
"""
BRAIN = """import spikeloop

with spikeloop.music(spikes_in={"in": 10}, spikes_out={"out": 10}) as host:
    for tick in host:
        times, channels = tick.spikes("in")
        tick.send("out", times, channels)
"""


def sensor_silent(robot, _):
    robot.scans(False)
    time.sleep(0.03)  # the last one is on its way
    return robot.sent_at


def kill(program, section=None, number=signal.SIGKILL):
    def fault(_, launcher):
        pid = jobs.find(launcher, program, section)
        begin = time.monotonic()
        os.kill(pid, number)
        return begin
    return fault


def ctrl_c(_, launcher):
    begin = time.monotonic()
    os.killpg(launcher, signal.SIGINT)
    return begin


def kill_launcher(_, launcher):
    begin = time.monotonic()
    os.kill(launcher, signal.SIGKILL)
    return begin


def emergency_stop(robot, _):
    begin = time.monotonic()
    robot.press_stop(True)
    return begin


class Fault(typing.NamedTuple):
    name: str
    make: typing.Callable  # of the robot and the launcher; when it began
    timeout_ms: float
    governor: str
    ends: bool  # the run
    when: typing.Callable = robots.Robot.is_driven
    undo: typing.Callable = None  # of the robot; it is driven again


def released(robot):
    robot.press_stop(False)


def sensor_back(robot):
    robot.scans(True)


def faults(layout):
    """Lists of faults that a run can have one after the other."""
    adapter = {"fused": ("spikeloop-fused",), "music": ("spikeloop-ros", "wheels"),
               "processes": ("spikeloop-fused", "control")}[layout]
    encoder = {"fused": [], "music": [("spikeloop-node", "encoder")],
               "processes": [("spikeloop-fused", "vision")]}[layout]
    alone = [
        Fault("simulator killed", kill("brain.py"), WATCHDOG_MS, "`watchdog`", True),
        *(Fault("encoder killed", kill(*place), WATCHDOG_MS, "`watchdog`", True) for place in encoder),
        Fault("adapter killed", kill(*adapter), 0, "guard", True),
        Fault("adapter killed at its first command", kill(*adapter), 0, "guard", True, robots.Robot.has_moved),
        Fault("Ctrl-C", ctrl_c, 0, "signal", True),
        Fault("launcher killed (SIGKILL)", kill_launcher, 0, "signal", True)]
    return [
        [Fault("sensor silent", sensor_silent, SENSOR_TIMEOUT_MS, "`sensor_timeout`", False, undo=sensor_back),
         Fault("emergency stop pressed", emergency_stop, 0, "message", False, robots.Robot.may_press_stop, released),
         Fault("adapter stopped (SIGSTOP)", kill(*adapter, number=signal.SIGSTOP), WATCHDOG_MS + 100,
               "guard: `watchdog` + 100 ms", False)],
        *([fault] for fault in alone)]


def command(file, version, layout):
    """The words that run an experiment file over this version of ROS; without --out."""
    spikeloop = PROGRAMS / "spikeloop"
    if layout != "music":
        return [spikeloop, "run", file, "--ros", version, *(["--layout", layout] if layout == "fused" else [])]
    file.write_text(f"ros: {version}\n{file.read_text()}")
    job = file.with_name("job")
    subprocess.run([spikeloop, "export", file, "--out", job], check=True, capture_output=True)
    return [spikeloop, "run", job / "experiment.music"]


def rest_ms(robot, launcher, fault):
    """Makes the fault: ms to the zero command after which there are but zeros."""
    begin = fault.make(robot, launcher.pid)
    robot.time_to_zero_ms(begin)
    if fault.ends:
        launcher.wait(60)
    # A tick that a busy machine delays stops the robot for a moment, before its time. What has left before the run's
    # end has come soon after it.
    stands = begin + (fault.timeout_ms + MARGIN_MS) / 1e3 + STANDS_S
    time.sleep(max(IN_FLIGHT_S, stands - time.monotonic()))
    rest = robot.time_to_rest_ms(begin)
    assert rest != float("inf"), [(at - begin, value) for at, value in robot.heard if at > begin]
    return rest


def prepared(folder, version, layout):
    """The words that run EXPERIMENT; it is written to this folder."""
    (folder / "faults.yaml").write_text(EXPERIMENT)
    (folder / "brain.py").write_text(BRAIN)
    return command(folder / "faults.yaml", version, layout)


def measured(robot, words, faults):
    """One run with these faults: ms to rest after each."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        robot.forget()
        robot.scans(True)
        log = open(folder / "printed", "w", encoding="utf-8")
        process = subprocess.Popen(
            [*words, "--out", folder / "run"], stdout=log, stderr=log, start_new_session=True)
        family, rests = {}, []
        try:
            for fault in faults:
                ros.until(lambda: fault.when(robot) or process.poll() is not None, "a command", 90)
                family = family or jobs.processes_of(process.pid)
                assert process.poll() is None
                ros.until(lambda: fault.when(robot), "a command")
                rests.append(rest_ms(robot, process, fault))
                if fault.undo is not None:
                    fault.undo(robot)
            return rests
        except AssertionError:
            print(f"{len(robot.heard)} commands came; the run printed\n{(folder / 'printed').read_text()}", flush=True)
            raise
        finally:
            robot.press_stop(False)
            # A stopped adapter hears no signal: it would be waited for in vain.
            for pid in family:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGCONT)
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGINT)
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(5)
            for pid in jobs.processes_of(process.pid).keys() | family.keys():
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            process.wait()
            log.close()


def table(arguments, version, layout, robot):
    """Prints a row a fault. @return those that took too long"""
    late = []
    with tempfile.TemporaryDirectory() as folder:
        words = prepared(pathlib.Path(folder), version, layout)
        for group in faults(layout):
            group = [fault for fault in group if not arguments.fault or arguments.fault in fault.name]
            repetitions = [measured(robot, words, group) for _ in range(arguments.repetitions if group else 0)]
            for fault, *times in zip(group, *repetitions):
                bound = fault.timeout_ms + MARGIN_MS
                if arguments.check and max(times) > bound:  # a busy machine may hold up one of three
                    times += [measured(robot, words, [fault])[0] for _ in range(2)]
                print(f"| {fault.name} | {layout} | {fault.governor} | {bound} ms | {version} | "
                      f"{statistics.median(times):.0f} ms | {max(times):.0f} ms |", flush=True)
                if statistics.median(times) > bound:
                    late.append(f"{fault.name}, {layout}, ROS {version}: {', '.join(f'{t:.0f}' for t in times)} ms")
    return late


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repetitions", type=int, default=10)
    parser.add_argument("--layout", choices=LAYOUTS, action="append")
    parser.add_argument("--ros", choices=["1", "2"], action="append")
    parser.add_argument("--fault", help="only those whose name has these words")
    parser.add_argument("--check", action="store_true", help="an error when one takes too long")
    arguments = parser.parse_args()
    print("| fault | layout | governed by | at most | ROS | median | max |\n|---|---|---|---|---|---|---|")
    late = []
    for version in arguments.ros or ["1", "2"]:
        with tempfile.TemporaryDirectory() as scratch, robots.robot(
                version, PROGRAMS, pathlib.Path(scratch)) as robot:
            for layout in arguments.layout or LAYOUTS:
                late += table(arguments, version, layout, robot)
    assert not (late and arguments.check), late


if __name__ == "__main__":
    sys.exit(main())
