#!/usr/bin/python3
"""An event camera on a topic, of ROS 1 and of ROS 2, in both layouts: every event is one spike, of its
channel and at its time."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import time


import camera
import ros
import runs

EXPERIMENT = """experiment: events
duration: 6 s
tick: 2 ms
ros: {ros}
nodes:
  eye:
    node: ros_event_sensor
    topic: /events
    message: {message}
    latency: 1500 ms
    polarity: split
  relay:
    simulator: builtin
    network:
      populations: {{in: {{model: input, size: 96}}, out: {{model: repeater, size: 96}}}}
      connections: [{{from: in, to: out, rule: one_to_one, delay: 2 ms}}]
      output: [out]
  count: {{node: rate_window, window: 100 ms}}
  go: {{node: ros_command, topic: /go, message: std_msgs/Float64MultiArray, limits: none}}
connections:
  - eye -> relay -> count [96] -> go [96]
"""
SILENCE = "no message on topic '/events' for 2 s"


class Run:
    """spikeloop run, whose loop runs when it says that it misses messages."""

    def __init__(self, command):
        self.text, self.silent = "", threading.Event()
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        text=True)
        self.reader = threading.Thread(target=self._read)
        self.reader.start()

    def _read(self):
        for line in self.process.stdout:
            self.text += line
            if SILENCE in line:
                self.silent.set()

    def wait(self):
        self.reader.join()
        return self.process.wait()


def play(pipe, data):
    """A message every 10 ms."""
    due = time.monotonic()
    for message in data:
        pipe.stdin.write(message.hex() + "\n")
        pipe.stdin.flush()
        due += 0.01
        time.sleep(max(0.0, due - time.monotonic()))


def recorded(folder):
    times, channels = runs.recordings.spikes(folder, "eye")
    return sorted(zip(times.tolist(), channels.tolist()))


def watch(folder, version, encoding, *more):
    """The events of a run as they should be and as they were recorded, from the first one on."""
    type_ = camera.ARRAY if encoding is None else camera.PACKET
    file = folder / "events.yaml"
    file.write_text(EXPERIMENT.format(ros=version, message=type_))
    messages = camera.film(int(version), 60)
    data = (camera.arrays(messages, version) if encoding is None
            else camera.packets(messages, encoding, version))
    pipe = subprocess.Popen([os.environ["MESSAGE_PIPE"], version, "/events", type_], text=True,
                            stdin=subprocess.PIPE)
    try:
        run = Run([runs.SPIKELOOP, "run", str(file), "--out", str(folder / "run"), *more])
        try:
            assert run.silent.wait(60), run.text
            play(pipe, data)
        finally:
            code = run.wait()
        assert code == 0, run.text
        assert "too late" not in run.text, run.text
    finally:
        pipe.stdin.close()
        assert pipe.wait(20) == 0
    want, got = sorted(camera.spikes(messages, camera.split)), recorded(folder / "run")
    assert len(got) == len(want) == 1500, (len(got), len(want))
    return [[(stamp - spikes[0][0], channel) for stamp, channel in spikes] for spikes in (want, got)]


def fused(version, encoding):
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        want, got = watch(scratch, version, encoding)
        assert got == want, (got[:5], want[:5])
        summary = json.loads((scratch / "run/summary.json").read_text())
        assert summary["processes"]["experiment"]["counters"]["eye.messages"] == 60, summary
        runs.spikeloop("replay", scratch / "run", "--out", scratch / "again")


def separate(version, encoding):
    """MUSIC's border has times in seconds: a nanosecond is rounded."""
    with tempfile.TemporaryDirectory() as scratch:
        want, got = watch(pathlib.Path(scratch), version, encoding, "--layout", "separate")
        assert [channel for _, channel in got] == [channel for _, channel in want]
        assert max(abs(a[0] - b[0]) for a, b in zip(got, want)) <= 1000, (got[:5], want[:5])


def main():
    for version, first, second in (("1", camera.Evt3(), None), ("2", camera.Evt2(), camera.Evt3())):
        with tempfile.TemporaryDirectory() as scratch, ros.place(version, pathlib.Path(scratch)):
            fused(version, first)
            separate(version, second)
        print(f"1500 events over ROS {version} in each layout")


if __name__ == "__main__":
    sys.exit(main())
