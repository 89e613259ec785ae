"""Files that somebody else wrote, and what Spikeloop says of them; for the tests beside this file."""

import os
import pathlib
import resource
import subprocess
import time

MEMORY = 8_000_000_000  # bytes of addresses
LONGEST_S = 5  # on a machine that does nothing else
HANGS_S = 60

# FILE is what is looked at.
EXPERIMENT = """experiment: hostile
duration: 100 ms
sync: unpaced
nodes:
  first: {node: spike_playback, file: FILE}
  out: {node: linear_readout, tau: 30 ms, weights: WEIGHTS}
connections:
  - first -> out [100]
""".replace("WEIGHTS", str([[0.01] * 100]))
ROBOT = """experiment: hostile
duration: 100 ms
sync: lockstep
robot: {simulator: mujoco, world: FILE}
nodes:
  scan: {node: ros_sensor, topic: /scan, message: LaserScan}
  eye: {node: rate_encoder, rate_max: 200 Hz}
  turn: {node: linear_readout, tau: 30 ms, weights: blocks}
  wheels: {node: ros_command, topic: /cmd_vel, message: Twist, fields: {linear.x: 0, angular.z: 1}}
connections:
  - scan -> eye [100] -> turn [100] -> wheels [2]
"""
NETWORK = """populations:
  input: {model: input, size: 100}
  cells: {model: repeater, size: 100}
connections:
  - {from: input, to: cells, rule: one_to_one, delay: 1 ms}
output: [cells]
"""


def arena(parts=""):
    """A world, with more parts in it."""
    file = programs().parent / "share/spikeloop/worlds/arena.xml"
    return file.read_text().replace("<worldbody>", f"{parts}\n<worldbody>", 1)


def programs():
    return pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])


class Answer:
    """What a program said, and how long it took."""

    def __init__(self, *arguments, cwd=None, env=None):
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        self.command = " ".join(map(str, arguments))
        begin = time.monotonic()
        try:
            done = subprocess.run(list(map(str, arguments)), cwd=cwd, env=env, preexec_fn=limit,
                                  stdin=subprocess.DEVNULL, capture_output=True, timeout=HANGS_S,
                                  check=False)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"{self.command}: hangs") from None
        self.seconds = time.monotonic() - begin
        self.code = done.returncode
        self.text = (done.stdout + done.stderr).decode(errors="replace")

    def trouble(self):
        """Why no user should see this; empty: an answer like any other."""
        if self.code < 0 or self.code in (134, 135, 136, 139):
            return f"crashes ({self.code})"
        if "bad_alloc" in self.text or "std::" in self.text or "Traceback" in self.text:
            return "an error of a library's"
        if self.code != 0 and not self.text.strip():
            return f"ends with {self.code} without a word"
        return ""

    def refused(self, *words):
        """It has an error that says these words."""
        assert not self.trouble(), f"{self.command}: {self.trouble()}\n{self.text[-2000:]}"
        assert self.code != 0, f"{self.command}: nothing wrong?\n{self.text[-2000:]}"
        for word in words:
            assert word in self.text, f"{self.command}: no word of {word}\n{self.text[-2000:]}"
        return self.seconds
