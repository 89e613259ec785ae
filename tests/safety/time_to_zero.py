#!/usr/bin/python3
"""From a fault to the zero command, as a subscriber of /cmd_vel sees it that is no part of Spikeloop.

Scans come from this program at 50 Hz; a script stands in the simulator's place; the command's timeouts are
declared. Every fault is made as often as asked for; a table in Markdown is printed. With --check it is an
error when one takes longer than the timeout that governs it and 200 ms.
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
import threading
import time

import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "fused"))
import ros  # noqa: E402  (the master of a test's own)

MARGIN_MS = 200
SENSOR_TIMEOUT_MS = 500
WATCHDOG_MS = 100

EXPERIMENT = f"""experiment: faults
ros: 1
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


class Robot:
    """Sends scans, and hears commands with the time of their arrival."""

    def __init__(self):
        rospy.init_node("robot", disable_signals=True, anonymous=True)
        self.scans = rospy.Publisher("/scan", LaserScan, queue_size=1, tcp_nodelay=True)
        self.stop = rospy.Publisher("/emergency_stop", Bool, queue_size=1, tcp_nodelay=True)
        self.manual = rospy.Publisher("/cmd_vel_manual", Twist, queue_size=1, tcp_nodelay=True)
        self.heard = []
        rospy.Subscriber("/cmd_vel", Twist, self._take, tcp_nodelay=True)
        self.sending = threading.Event()
        self.sent_at = 0.0
        threading.Thread(target=self._send, daemon=True).start()

    def _take(self, message):
        self.heard.append((time.monotonic(), message.linear.x))

    def _send(self):
        scan = LaserScan(range_min=0.1, range_max=4.1, ranges=[3.0] * 10)
        while True:
            self.sending.wait()
            self.sent_at = time.monotonic()
            self.scans.publish(scan)
            time.sleep(0.02)

    def is_driven(self):
        now = time.monotonic()
        recent = [value for at, value in self.heard[-3:] if now - at < 0.2]
        return len(recent) == 3 and all(recent)

    def time_to_zero_ms(self, begin, patience_s=10):
        end = time.monotonic() + patience_s
        while time.monotonic() < end:
            for at, value in list(self.heard):
                if at > begin and value == 0:
                    return 1e3 * (at - begin)
            time.sleep(0.002)
        return float("inf")

    def drives_after(self, begin):
        """What came after the first zero since then and was none."""
        zero = next((at for at, value in self.heard if at > begin and value == 0), begin)
        return [value for at, value in self.heard if at > zero and value != 0]


def processes_of(launcher):
    """Program and environment of every process that the launcher has started, by id."""
    parents, known = {}, {}
    for entry in pathlib.Path("/proc").iterdir():
        with contextlib.suppress(OSError, ValueError, IndexError):
            pid = int(entry.name)
            parents[pid] = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
            words = (entry / "cmdline").read_text(errors="replace").split("\0")
            # What MUSIC has started keeps MUSIC's command line; scripts have Python's file.
            words = words[1:2] + [os.readlink(entry / "exe")]
            known[pid] = ([os.path.basename(word) for word in words],
                          (entry / "environ").read_text(errors="replace").split("\0"))

    def belongs(pid):
        while pid in parents:
            if pid == launcher:
                return True
            pid = parents[pid]
        return False
    return {pid: known[pid] for pid in known if belongs(pid)}


def find(launcher, program, section=None):
    """Of several processes of a program that of the section."""
    for pid, (words, environment) in processes_of(launcher).items():
        if program in words and (section is None or any(
                word.startswith(f"_MUSIC_CONFIG_={section}:") for word in environment)):
            return pid
    raise AssertionError(f"no process runs {program}")


def sensor_silent(robot, _):
    robot.sending.clear()
    time.sleep(0.03)  # the last one is on its way
    return robot.sent_at


def kill(program, section=None, number=signal.SIGKILL):
    def fault(_, launcher):
        pid = find(launcher, program, section)
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
    robot.stop.publish(Bool(True))
    return begin


def faults(layout):
    """What happens, how it is made, the timeout in ms and who has it, and whether the run ends."""
    adapter = ("spikeloop-ros", "wheels") if layout == "separate" else ("spikeloop-fused-music",)
    encoder = [("encoder killed", kill("spikeloop-node", "encoder"), WATCHDOG_MS, "`watchdog`", True)]
    return [
        ("sensor silent", sensor_silent, SENSOR_TIMEOUT_MS, "`sensor_timeout`", False),
        ("simulator killed", kill("brain.py"), WATCHDOG_MS, "`watchdog`", True),
        *(encoder if layout == "separate" else []),
        ("adapter killed", kill(*adapter), 0, "guard", True),
        ("adapter stopped (SIGSTOP)", kill(*adapter, number=signal.SIGSTOP), WATCHDOG_MS + 100,
         "guard: `watchdog` + 100 ms", False),
        ("Ctrl-C", ctrl_c, 0, "signal", True),
        ("launcher killed (SIGKILL)", kill_launcher, 0, "signal", True),
        ("emergency stop pressed", emergency_stop, 0, "message", False)]


def measured(spikeloop, robot, layout, make, ends):
    """One run with one fault: ms to the zero command."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "faults.yaml").write_text(EXPERIMENT)
        (folder / "brain.py").write_text(BRAIN)
        robot.heard.clear()
        robot.sending.set()
        log = open(folder / "printed", "w+", encoding="utf-8")
        process = subprocess.Popen(
            [spikeloop, "run", str(folder / "faults.yaml"), "--layout", layout, "--out",
             str(folder / "run"), "--no-record"], stdout=log, stderr=log, start_new_session=True)
        family = {}
        try:
            ros.until(lambda: robot.is_driven() or process.poll() is not None, "a command", 90)
            family = processes_of(process.pid)
            log.seek(0)
            assert process.poll() is None, log.read()
            ros.until(robot.is_driven, "a command")
            begin = make(robot, process.pid)
            result = robot.time_to_zero_ms(begin)
            if ends:
                process.wait(60)
        finally:
            robot.stop.publish(Bool(False))
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGINT)
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(5)
            for pid in processes_of(process.pid).keys() | family.keys():
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            process.wait()
            log.close()
        again = robot.drives_after(begin) if ends else []
        assert not again, f"driven again: {again}"
        return result


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", required=True, type=pathlib.Path)
    parser.add_argument("--repetitions", type=int, default=10)
    parser.add_argument("--layout", choices=["fused", "separate"], action="append")
    parser.add_argument("--check", action="store_true", help="an error when one takes too long")
    arguments = parser.parse_args()
    spikeloop = str(arguments.programs.resolve() / "spikeloop")
    print("| fault | layout | governed by | at most | median | max |\n|---|---|---|---|---|---|")
    late = []
    with tempfile.TemporaryDirectory() as scratch, ros.master(pathlib.Path(scratch)):
        robot = Robot()
        for layout in arguments.layout or ["fused", "separate"]:
            for name, make, timeout, governor, ends in faults(layout):
                times = [measured(spikeloop, robot, layout, make, ends)
                         for _ in range(arguments.repetitions)]
                bound = timeout + MARGIN_MS
                print(f"| {name} | {layout} | {governor} | {bound} ms | "
                      f"{statistics.median(times):.0f} ms | {max(times):.0f} ms |", flush=True)
                late += [f"{name}, {layout}: {max(times):.0f} ms"] if max(times) > bound else []
    assert not (late and arguments.check), late


if __name__ == "__main__":
    sys.exit(main())
