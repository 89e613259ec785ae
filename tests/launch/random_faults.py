#!/usr/bin/python3
"""Launches a job of five programs again and again, each time with another fault, and looks at what
is left: no launch may hang, leave a process behind, or end without naming the cause.

A fault is a signal to one of the programs, to mpirun or to the launcher at a random moment, or a few
random bytes in one of the job's files.

  random_faults.py --bin build/release/bin --launches 500 --seed 1
"""

import argparse
import os
import pathlib
import random
import re
import signal
import subprocess
import sys
import tempfile
import time

LABELS = ["source", "encoder", "network", "decoder", "sink"]
JOB = """stoptime=4
music_timestep=0.002
[source]
np=1
binary=zmq_cont_adapter
message_type=FloatArray
zmq_addr=ipc://{folder}/in
initial=0.5
[encoder]
np=1
binary=rate_encoder
rate_max=200
[network]
np=1
binary=spikeloop-network
network=net.yaml
[decoder]
np=1
binary=linear_readout_decoder
weights_filename=w.json
[sink]
np=1
binary=cont_zmq_adapter
message_type=FloatArray
zmq_addr=ipc://{folder}/out
source.out -> encoder.in [3]
encoder.out -> network.in [3]
network.out -> decoder.in [3]
decoder.out -> sink.in [2]
"""
NETWORK = """populations:
  input: {model: input, size: 3}
  cells: {model: repeater, size: 3}
connections:
  - {from: input, to: cells, rule: one_to_one, delay: 1 ms}
output: [cells]
"""
WEIGHTS = "[[1, 0, 0], [0, 1, 0]]\n"
SIGNALS = ["KILL", "TERM", "SEGV", "ABRT", "BUS", "FPE", "STOP", "QUIT", "HUP"]
START_S, STALL_S = 15, 4
LONGEST_S = START_S + STALL_S + 20  # mpirun has 10 s to end


def processes(marker):
    """pid: (command, section) of all that have our marker in their environment."""
    found = {}
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            environment = (entry / "environ").read_bytes()
            if marker not in environment:
                continue
            section = re.search(rb"\0_MUSIC_CONFIG_=([^:]*):", b"\0" + environment)
            command = (entry / "comm").read_text().strip()
            state = (entry / "stat").read_text().rsplit(")", 1)[1].split()[0]
        except OSError:
            continue
        if state != "Z":
            found[int(entry.name)] = (command, section[1].decode() if section else "")
    return found


def hit(marker, target, number):
    """Sends the signal once its target runs. Returns whether it did."""
    deadline = time.time() + 5
    while time.time() < deadline:
        for pid, (command, section) in processes(marker).items():
            if section == target or (target == "mpirun" and command == "mpirun"):
                try:
                    os.kill(pid, number)
                    return True
                except ProcessLookupError:
                    pass
        time.sleep(0.02)
    return False


def spoil(path, dice):
    data = bytearray(path.read_bytes())
    for _ in range(dice.randint(1, 3)):
        data[dice.randrange(len(data))] = dice.choice(b"\0\xff[]{}=->.x9 \n\"#\\")
    path.write_bytes(bytes(data))


class Launch:
    """One job, one fault."""

    def __init__(self, programs, dice):
        self.dice = dice
        self.programs = programs
        self.kind = dice.choice(["program"] * 7 + ["mpirun", "launcher", "file", "file"])
        # mpirun passes SIGABRT on to the programs.
        self.signal = dice.choice([s for s in SIGNALS if s != "ABRT" or self.kind != "mpirun"])
        self.target = dice.choice(LABELS) if self.kind == "program" else self.kind
        self.moment_s = dice.uniform(0, 1.5)

    def write_files(self, folder):
        (folder / "job.music").write_text(JOB.format(folder=folder))
        (folder / "net.yaml").write_text(NETWORK)
        (folder / "w.json").write_text(WEIGHTS)
        if self.kind == "file":
            self.target = self.dice.choice(["job.music", "net.yaml", "w.json"])
            spoil(folder / self.target, self.dice)

    def run(self):
        with tempfile.TemporaryDirectory(prefix="faults-") as name:
            folder = pathlib.Path(name)
            self.write_files(folder)
            self.marker = f"SPIKELOOP_FAULTS={name}".encode()
            environment = dict(os.environ, SPIKELOOP_FAULTS=name)
            started = time.time()
            # A spoilt stoptime would let it run for ever.
            child = subprocess.Popen(
                [self.programs / "spikeloop", "run", "job.music", "--start-timeout", str(START_S),
                 "--stall-timeout", str(STALL_S), "--duration", "4"], cwd=folder, env=environment,
                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace")
            self.strike(child)
            self.wait(child)
            self.taken_s = time.time() - started
            self.left = self.what_is_left()

    def strike(self, child):
        self.struck = True
        if self.kind == "file":
            return
        time.sleep(self.moment_s)
        number = getattr(signal, f"SIG{self.signal}")
        if self.kind == "launcher":
            if self.signal == "STOP":
                self.signal, number = "KILL", signal.SIGKILL
            child.send_signal(number)
        else:
            self.struck = hit(self.marker, self.target, number)

    def wait(self, child):
        self.hung = False
        try:
            errors = child.communicate(timeout=LONGEST_S)[1]
        except subprocess.TimeoutExpired:
            self.hung = True
            child.kill()
            errors = child.communicate()[1]
        self.exit_code = child.returncode
        lines = [line for line in errors.replace("\r", "\n").split("\n") if line.strip()]
        self.last_line = lines[-1] if lines else ""

    def what_is_left(self):
        deadline = time.time() + 5  # the launcher itself may have been killed
        while (left := processes(self.marker)) and time.time() < deadline:
            time.sleep(0.05)
        for pid in left:
            os.kill(pid, signal.SIGKILL)
        return left

    def complaint(self):
        if self.hung:
            return "hung"
        if self.left:
            return f"left behind: {self.left}"
        if self.kind == "launcher" or not self.struck or self.exit_code == 0:
            # A stopped mpirun, a harmless byte, or a signal that came too late.
            return ""
        words = {"program": f"'{self.target}'", "mpirun": "mpirun"}.get(self.kind, "spikeloop: ")
        if self.kind == "file" and self.exit_code not in (2, 3, 4):
            return "a wrong file has exit code 2 or 4, or its partner 3"
        return "" if words in self.last_line else f"does not name {words}"

    def text(self):
        what = self.target if self.kind == "file" else (
            f"SIG{self.signal} to {self.target} after {self.moment_s:.2f} s")
        return f"{what}: exit {self.exit_code} after {self.taken_s:.1f} s: {self.last_line}"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/release/bin"))
    parser.add_argument("--launches", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    dice = random.Random(arguments.seed)
    bad = 0
    longest_s = 0.0
    for number in range(1, arguments.launches + 1):
        launch = Launch(arguments.bin.resolve(), random.Random(dice.getrandbits(64)))
        launch.run()
        complaint = launch.complaint()
        bad += complaint != ""
        longest_s = max(longest_s, launch.taken_s)
        print(f"{number}: {launch.text()}" + (f"  <-- {complaint}" if complaint else ""), flush=True)
    print(f"{arguments.launches} launches, {bad} with a complaint, the longest took {longest_s:.1f} s")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
