#!/usr/bin/python3
"""A closed loop for half an hour: 1 ms ticks in real time over ROS 2, with laser, odometry and pictures of
640x480. Nothing may grow, no command may be lost, and every message that was sent is accounted for.

The vehicle is spikeloop-robot. Pictures come from fastdds_witness, a node on another vendor's DDS that also
hears every command, scan and odometry reliably, with the number that its publisher has given it. Memory is
what a process has to itself and cannot give back (Anonymous and Swap of /proc/PID/smaps_rollup).
"""

import argparse
import contextlib
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

sys.path[:0] = [str(pathlib.Path(__file__).parents[1] / name) for name in ("fused", "support")]
import jobs  # noqa: E402
import ros  # noqa: E402

HERE = pathlib.Path(__file__).parent
PICTURES_HZ = 30
# Growth of a process over the last four fifths of the run, by least squares. In 24 of 30 minutes 2 bytes a tick,
# 80 bytes a scan or three pictures make more. A machine that stands still for a moment makes less: another picture
# waits then, and the heap keeps its megabyte, which counts one and a half times when it comes halfway.
MOST_GROWTH_KIB = 2048
MOST_MORE = 2  # threads, descriptors or files
SETTLING = 0.2
# Cyclone DDS writes all that arrives into buffers of a megabyte a thread, from end to end. Where only discovery
# arrives it does so for half an hour before it begins anew: growth, but none without end. Smaller ones are used up
# while the run settles.
BUFFERS = "<Sizing><ReceiveBufferSize>192 KiB</ReceiveBufferSize></Sizing>"
STOPPED = 130  # the exit code after Ctrl-C
# Sent by a publisher that knows its subscribers before they know it: a second of messages at most.
UNHEARD = {"scan": 20, "odom": 50, "eye": PICTURES_HZ, "cmd_vel": 100}


class Witness:
    """fastdds_witness, led line by line."""

    def __init__(self, program, domain):
        self.process = subprocess.Popen([program, str(domain), "640", "480", str(PICTURES_HZ)], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        assert self._line() == ["ready"]

    def _line(self):
        return self.process.stdout.readline().split()

    def _ask(self, question):
        self.process.stdin.write(question + "\n")
        self.process.stdin.flush()

    def knows_the_run(self):
        """The publishers of commands, process and guard, and a subscriber of pictures: a second one, which is
        reliable, comes when it has met the publisher."""
        self._ask("known")
        _, publishers, subscribers = self._line()
        return publishers == "2" and int(subscribers) >= 1

    def send(self, pictures):
        self._ask(f"send {pictures}")

    def wait_for_sent(self):
        return int(self._line()[1])

    def heard(self):
        """By topic: (messages, numbers of the first and the last of them) of every publisher."""
        self._ask("heard")
        heard = {}
        while (words := self._line()) != ["all"]:
            heard.setdefault(words[1], []).append(tuple(map(int, words[2:])))
        return heard

    def end(self):
        self.process.stdin.close()
        assert self.process.wait(30) == 0, "fastdds_witness has failed"


def memory_kib(pid):
    rollup = pathlib.Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="utf-8")
    sizes = dict(line.split(":", 1) for line in rollup.splitlines()[1:])
    return sum(int(sizes[name].split()[0]) for name in ("Anonymous", "Swap"))


def count(folder):
    return len(list(pathlib.Path(folder).iterdir()))


class Usage:
    """Memory, threads and descriptors of the processes of a job, by name, and the files that they have written,
    once a second. A process that is gone is a crash."""

    def __init__(self, pids, folder):
        self.pids = pids
        self.folder = folder
        self.begin = time.monotonic()
        self.times = []
        self.samples = {}

    def sample(self):
        self.times.append(time.monotonic() - self.begin)
        for name, pid in self.pids.items():
            try:
                self._add(f"memory of {name} (KiB)", memory_kib(pid))
                self._add(f"threads of {name}", count(f"/proc/{pid}/task"))
                self._add(f"descriptors of {name}", count(f"/proc/{pid}/fd"))
            except (OSError, IndexError) as error:
                logs = "\n".join(log.read_text() for log in self.folder.glob("*.txt"))
                raise AssertionError(f"{name} has ended after {self.times[-1]:.0f} s: {error}\n{logs}") from error
        self._add("files", sum(len(names) for _, _, names in os.walk(self.folder)))

    def _add(self, what, size):
        self.samples.setdefault(what, []).append(size)

    def growth(self, sizes):
        """Over the last four fifths of the run, by least squares."""
        points = [point for point in zip(self.times, sizes) if point[0] >= SETTLING * self.times[-1]]
        mean_t, mean_size = (sum(values) / len(points) for values in zip(*points))
        slope = (sum((t - mean_t) * (size - mean_size) for t, size in points)
                 / sum((t - mean_t) ** 2 for t, _ in points))
        return slope * (points[-1][0] - points[0][0])

    def show(self):
        for what, sizes in self.samples.items():
            growth = self.growth(sizes)
            day = growth * 86400 / ((1 - SETTLING) * self.times[-1])
            print(f"{what}: {sizes[0]} at first, {sizes[-1]} at last, {max(sizes)} at most; growth {growth:.1f}, "
                  f"in 24 h {day:.0f}", flush=True)

    def faults(self, most_growth_kib):
        most = {what: most_growth_kib if what.startswith("memory") else MOST_MORE for what in self.samples}
        return [f"{what}: grows by more than {most[what]}" for what, sizes in self.samples.items()
                if self.growth(sizes) > most[what]]


@contextlib.contextmanager
def started(command, log):
    """A program in a group of its own, of which nothing is left behind."""
    with open(log, "w", encoding="utf-8") as output:
        process = subprocess.Popen(command, stdout=output, stderr=output, start_new_session=True)
    try:
        yield process
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def drive(programs, witness, folder, seconds):
    """The job, from its start until Ctrl-C; its summary."""
    run = [programs / "spikeloop", "run", HERE / "soak.yaml", "--out", folder / "run", "--no-record"]
    robot = [programs / "spikeloop-robot", "--ros", "2", "--duration", str(seconds)]
    with started(run, folder / "run.txt") as launcher:
        def ready():
            assert launcher.poll() is None, (folder / "run.txt").read_text()
            return witness.knows_the_run()
        ros.until(ready, "the run's begin", 60)
        time.sleep(1)  # it knows the witness, too
        with started(robot, folder / "robot.txt") as vehicle:
            usage = Usage({"spikeloop": launcher.pid, "spikeloop-robot": vehicle.pid,
                           "spikeloop-fused": jobs.find(launcher.pid, "spikeloop-fused"),
                           "spikeloop-guard": jobs.guard_of(launcher.pid)}, folder)
            witness.send(int((seconds - 2) * PICTURES_HZ))
            for second in range(1, seconds - 1):
                time.sleep(max(0.0, usage.begin + second - time.monotonic()))
                usage.sample()
            usage.show()
            sent = witness.wait_for_sent()
            # Beside other work the robot's time falls behind, a little in every second.
            code = vehicle.wait(30 + seconds / 10)
            assert code == 0, f"spikeloop-robot, exit code {code}:\n{(folder / 'robot.txt').read_text()}"
        launcher.send_signal(signal.SIGINT)
        code = launcher.wait(30)
    said = (folder / "run.txt").read_text()
    assert code == STOPPED, f"spikeloop run, exit code {code}:\n{said}"
    print(said + (folder / "robot.txt").read_text(), end="")
    return json.loads((folder / "run/summary.json").read_text()), sent, usage


def faults_of_commands(counters, heard):
    """All that left came, in a row; that of the guard, too, where a machine that stood still made it speak."""
    came, _, sent = max(heard["/cmd_vel"])
    print(f"commands: {counters['wheels.sent']} sent, {came} came", flush=True)
    whole = counters["wheels.sent"] == sent and all(
        came == last - first + 1 and first <= UNHEARD["cmd_vel"] for came, first, last in heard["/cmd_vel"])
    return [] if whole else [f"commands are lost: {heard['/cmd_vel']} of {counters['wheels.sent']}"]


def faults_of_sensor(counters, name, sent):
    taken, lost = counters[f"{name}.messages"], counters[f"{name}.lost"]
    missing = sent - taken - lost
    print(f"{name}: {sent} sent, {taken} taken, {lost} lost on the way or replaced by newer ones, {missing} sent "
          "before the two knew each other", flush=True)
    faults = [] if 0 <= missing <= UNHEARD[name] else [f"{missing} messages of {name} are not accounted for"]
    wrong = [key for key in ("malformed", "wrong_type", "cropped", "short_messages") if counters[f"{name}.{key}"]]
    return faults + [f"{name}: {key}" for key in wrong]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=HERE.parents[1] / "build/release")
    parser.add_argument("--minutes", type=float, default=30)
    parser.add_argument("--most-growth", type=float, default=MOST_GROWTH_KIB, metavar="KIB",
                        help="of the memory of a process (default: %(default)s)")
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    with tempfile.TemporaryDirectory() as folder, ros.domain() as domain:
        os.environ["CYCLONEDDS_URI"] = BUFFERS
        witness = Witness(build / "tests/bin/fastdds_witness", domain)
        try:
            summary, pictures, usage = drive(build / "bin", witness, pathlib.Path(folder),
                                             round(60 * arguments.minutes))
            heard = witness.heard()
            witness.end()
        finally:
            witness.process.kill()
            witness.process.wait()
    counters = summary["processes"]["experiment"]["counters"]
    stops = {key: value for key, value in counters.items() if key.startswith("wheels.stops_") and value}
    print(f"simulated {summary['simulated_s']:.0f} s, {summary['overruns']} overruns; stops: {stops}", flush=True)
    faults = faults_of_commands(counters, heard) + faults_of_sensor(counters, "eye", pictures)
    for name in ("scan", "odom"):
        (came, first, last), = heard[f"/{name}"]
        whole = came == last - first + 1
        faults += [] if whole else [f"fastdds_witness has heard {came} messages of /{name}, {first} to {last}"]
        faults += faults_of_sensor(counters, name, last)
    faults += usage.faults(arguments.most_growth)
    assert not faults, "; ".join(faults)


if __name__ == "__main__":
    sys.exit(main())
