#!/usr/bin/python3
"""sync: sim_time: the loop is exactly as far as /clock, whether that is slow, stands still or jumps;
it ends the run when its publisher has gone. The shipped robot at half and at three times real time."""

import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import xmlrpc.client

import ros
import runs

EXPERIMENT = """experiment: echo
duration: 0.5 s
sync: sim_time
ros: 1
nodes:
  where: {node: ros_sensor, topic: /where, message: std_msgs/Float64MultiArray}
  same: {node: clip, min: -1, max: 1}
  go: {node: ros_command, topic: /go, message: std_msgs/Float64MultiArray, command_rate: 100 Hz,
       watchdog: 2 s}
connections:
  - where -> same [1] -> go [1]
"""
ODD_CLOCK = """
import rospy
from std_msgs.msg import Float64
rospy.init_node("odd_clock", disable_rosout=True)
clock = rospy.Publisher("/clock", Float64, latch=True, queue_size=1)
clock.publish(1)
rospy.spin()
"""
START_MS = 1_000_000  # the simulator has run for a while
DRIVES_BY_MS = 100
PAUSE_S = 4  # longer than watchdog and max_age


class Simulator:
    """Publishes /clock and /where, and hears /go."""

    def __init__(self):
        import rospy
        from rosgraph_msgs.msg import Clock
        from std_msgs.msg import Float64MultiArray
        rospy.init_node("simulator", anonymous=True, disable_rosout=True, disable_signals=True)
        self.stamp = rospy.Time
        self.clock = rospy.Publisher("/clock", Clock, queue_size=1000)
        self.where = rospy.Publisher("/where", Float64MultiArray, queue_size=10)
        self.heard, self.known = [], set()
        self.go = rospy.Subscriber("/go", Float64MultiArray, self.heard.append)

    def show(self, milliseconds):
        self.clock.publish(clock=self.stamp(*divmod((START_MS + milliseconds) * 1_000_000, 10**9)))

    def join(self):
        """The experiment has subscribed to everything, and has a reading."""
        ros.until(lambda: len(self.new_subscriptions()) == 2, "a subscription")
        self.known |= {name for name, _ in self.new_subscriptions()}
        self.where.publish(data=[0.5])
        time.sleep(0.5)  # on its way, on a connection of its own

    def new_subscriptions(self):
        """Of an experiment that has not been here before; those of the dead live on for a while."""
        import rospy
        connections = xmlrpc.client.ServerProxy(rospy.get_node_uri()).getBusInfo("/test")[2]
        return {(other, topic) for _, other, direction, _, topic, *_ in connections
                if direction == "o" and other.startswith("/spikeloop_echo") and
                other not in self.known}

    def drives(self):
        """Lets the clock go on until commands come of what was measured; how far it is then, in ms."""
        for shown in range(DRIVES_BY_MS):
            self.show(shown)
            end = time.monotonic() + 0.2
            while time.monotonic() < end:
                if self.heard and self.heard[-1].data[0] == 0.5:
                    return shown
                time.sleep(0.01)
        raise AssertionError("no command of 0.5")


class Run:
    """An experiment in the background; its lines as they come."""

    def __init__(self, file, folder, stall_s=6, start_s=60):
        self.folder = folder
        self.process = subprocess.Popen([runs.SPIKELOOP, "run", str(file), "--out", str(folder),
                                         "--stall-timeout", str(stall_s), "--start-timeout", str(start_s)],
                                        stderr=subprocess.PIPE, text=True)
        self.printed = ""
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for line in self.process.stderr:
            self.printed += line

    def says(self, text):
        ros.until(lambda: text in self.printed or self.process.poll() is not None, text)
        assert text in self.printed, f"{text}\n{self.printed}"

    def end(self, code):
        try:
            assert self.process.wait(60) == code, self.printed
        finally:
            self.process.kill()
            self.reader.join()
        return json.loads((self.folder / "summary.json").read_text())["processes"]["experiment"]

    def interrupt(self):
        self.process.send_signal(signal.SIGINT)
        return self.end(130)


def check_counters(counters):
    """A clock that stands still stops nobody: neither for silence, nor for old data."""
    for reason in ("no_tick", "data_too_old", "without_value"):
        assert counters[f"go.stops_{reason}"] == 0, counters


def pause(simulator, begin):
    """Paused in the middle: the brain is where the clock is, and Ctrl-C ends it."""
    run = begin("pause")
    simulator.join()
    simulator.drives()
    for shown in range(DRIVES_BY_MS, 201, 10):
        simulator.show(shown)
        time.sleep(0.01)
    run.says("/clock has stood still at 1000.2 s for 3 s: is the simulator paused?")
    time.sleep(PAUSE_S - 3)
    heard = len(simulator.heard)
    time.sleep(0.5)
    assert len(simulator.heard) == heard, "commands are repeated in simulated time"
    simulator.show(300)
    run.says("/clock continues")
    ros.until(lambda: len(simulator.heard) > heard, "a command")
    time.sleep(1)
    report = run.interrupt()
    # The tick that begins at 0.3 s is the last one.
    assert report["summary"]["simulated_s"] == 0.301, report
    check_counters(report["counters"])
    assert report["summary"]["age_max_ms"] < 400, report
    assert simulator.heard[-1].data[0] == 0 and report["counters"]["go.stops_ended"] == 1, report


def jump(simulator, begin):
    """Ticks that the clock has passed are computed at once, to the end of the duration."""
    run = begin("jump")
    simulator.join()
    shown = simulator.drives()
    for _ in range(3):  # so that the period of the clock is known
        shown += 1
        simulator.show(shown)
        time.sleep(0.02)
    simulator.show(300)
    time.sleep(0.2)
    simulator.show(10_000)
    report = run.end(0)
    assert report["summary"]["simulated_s"] == 0.5, report
    # Begun more than a tick late: those from `shown` + 1 to 298 ms, and from 301 to 499 ms; a few more where a time
    # was overtaken by the next one.
    assert 298 - shown + 199 <= report["summary"]["overruns"] <= 499, report
    run.says("of 500 ticks began more than a tick late. Computing 1 s takes ")
    run.says("let the simulator run at less than ")
    check_counters(report["counters"])


def driving(simulator, begin, name, **options):
    """A run at 0.1 s, that drives."""
    run = begin(name, **options)
    simulator.join()
    simulator.drives()
    simulator.show(DRIVES_BY_MS)
    return run


def ended(simulator, run, words):
    """With an error that says so, and the robot is stopped."""
    run.end(3)
    run.says(words)
    ros.until(lambda: simulator.heard[-1].data[0] == 0, "a zero command")


def back(simulator, begin):
    """Again and again: of times that come at once, a run takes the newest."""
    run = driving(simulator, begin, "back")

    def has_ended():
        for shown in (DRIVES_BY_MS, 20):
            simulator.show(shown)
            time.sleep(0.1)
        return run.process.poll() is not None

    ros.until(has_ended, "the end")
    ended(simulator, run, " to 1000.02 s: the simulator was set back, or two programs publish it ('rostopic info "
          "/clock')")
    run.says("/clock went back from 1000.")


def gone(simulator, begin):
    run = driving(simulator, begin, "gone", stall_s=3)
    simulator.clock.unregister()
    # rospy may drop what it has not sent yet.
    ended(simulator, run, " s for 3 s, and has no publisher any more")


def slow_clock(simulator, begin):
    """The clock of a simulator with steps of 10 ms: no tick is late."""
    run = begin("slow-clock")
    simulator.join()
    for shown in range(0, 600, 10):
        simulator.show(shown)
        time.sleep(0.02)
    report = run.end(0)
    assert report["summary"]["simulated_s"] == 0.5 and report["summary"]["overruns"] == 0, report
    run.says("/clock has a period of 10 ms, a tick is 1 ms")
    assert "more than a tick late" not in run.printed, run.printed


def no_clock(file, folder, reason):
    """Ends the run after --start-timeout."""
    runs.refused(f"no message on /clock within 2 s: {reason} ... [SL0702]", "run", file, "--out", folder,
                 "--start-timeout", "2", code=3)


def paused_from_the_start(simulator, begin):
    """A simulator that is paused before it sends a time is waited for, longer than --start-timeout."""
    run = begin("paused-from-the-start", start_s=2)
    simulator.join()
    run.says("no message on /clock for 3 s, which has a publisher: is the simulator paused? The experiment waits")
    simulator.drives()
    run.interrupt()
    simulator.heard.clear()


def paused_next_to_a_dead_node(simulator, begin, master):
    """A killed publisher that the master still lists does not end the wait for a paused one."""
    dead = "http://127.0.0.1:9/"
    with xmlrpc.client.ServerProxy(master) as proxy:
        proxy.registerPublisher("/dead", "/clock", "rosgraph_msgs/Clock", dead)
        run = begin("paused-next-to-a-dead-node", start_s=2)
        simulator.join()
        run.says("no connection with its publisher /dead: no node answers")
        run.says("no message on /clock for 3 s, which has a publisher: is the simulator paused? The experiment waits")
        proxy.unregisterPublisher("/dead", "/clock", dead)
    simulator.drives()
    run.says("first message on /clock")
    run.interrupt()
    simulator.heard.clear()


def wrong_clock(file, folder):
    """A clock of another type is an error at once."""
    with ros.program(sys.executable, "-c", ODD_CLOCK):
        runs.refused("topic '/clock' carries std_msgs/Float64, not rosgraph_msgs/Clock; node /odd_clock publishes it; "
                     "... [SL0508]", "run", file, "--out", folder, code=3)


def silence(begin, command):
    run = begin("silence")
    run.says("no message on /clock for 3 s, and sync: sim_time waits for it: is use_sim_time "
             f"set, and does the simulator publish /clock? '{command} hz /clock' shows it")
    run.interrupt()


def shipped_robot(scratch, version):
    for factor, duration in (("0.5", "2 s"), ("3", "4 s")):
        file = runs.new_experiment(scratch / "explorer.yaml", sync="sim_time", ros=version,
                                   duration=duration, real_time_factor=factor)
        summary, _ = runs.run(file, scratch / f"factor{factor}-ros{version}")
        # A busy machine is slower; nothing is faster than the robot.
        assert 0.1 < summary["real_time_factor"] < float(factor) * 1.05, summary
        counters = summary["processes"]["experiment"]["counters"]
        # 3 times as fast, the robot of a busy machine may hear of the commands when all is over.
        assert summary["distance_m"] > 0.3 or factor == "3" and counters["wheels.commands"] > 10, summary
        assert counters["wheels.stops_ended"] == 1, counters


def followed_in_ros2(scratch):
    """The clock of the shipped robot, which is paused, goes on, and begins again. (Only in real time it is
    wall time, which does not begin again.)"""
    robot = [runs.programs() / "spikeloop-robot", "--ros", "2", "--real-time-factor", "0.9"]
    file = runs.new_experiment(scratch / "follower.yaml", sync="sim_time", ros="2", duration="60 s")
    text = file.read_text()
    own = next(line for line in text.splitlines() if line.startswith("robot:"))
    file.write_text(text.replace(own, ""))
    silence(lambda name: Run(file, scratch / f"{name}-ros2"), "ros2 topic")
    no_clock(file, scratch / "no-clock-ros2", "it has no publisher")
    run = Run(file, scratch / "follower")
    with ros.program(*robot) as simulator:
        ros.until(lambda: runs.trajectory(scratch / "follower"), "a path")
        simulator.send_signal(signal.SIGSTOP)
        run.says("for 3 s: is the simulator paused? The experiment waits")
        simulator.send_signal(signal.SIGCONT)
        run.says("/clock continues")
    with ros.program(*robot):
        report = run.end(3)
    assert report["summary"].get("simulated_s", 0) < 60, report
    run.says("the simulator was set back, or two programs publish it ('ros2 topic info /clock')")


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        file = scratch / "echo.yaml"
        file.write_text(EXPERIMENT)
        with ros.master(scratch) as master:
            wrong_clock(file, scratch / "wrong-clock")
            subprocess.run(["/usr/bin/rosparam", "set", "use_sim_time", "true"], check=True)
            silence(lambda name: Run(file, scratch / name), "rostopic")
            no_clock(file, scratch / "no-clock", "it has no publisher")
            simulator = Simulator()
            def begin(name, **options):
                return Run(file, scratch / name, **options)

            paused_from_the_start(simulator, begin)
            paused_next_to_a_dead_node(simulator, begin, master)
            for test in (pause, jump, slow_clock, back, gone):
                simulator.heard.clear()
                test(simulator, begin)
        shipped_robot(scratch, "1")
        with ros.domain():
            followed_in_ros2(scratch)
            shipped_robot(scratch, "2")
    print("as far as /clock: slow, paused, ahead; an error when it goes back")


if __name__ == "__main__":
    sys.exit(main())
