#!/usr/bin/python3
"""A .music file with an event camera as an experiment, that as a .music file again, and so on: the same
every time; and the experiment is one that check likes."""

import pathlib
import sys
import tempfile

import runs

JOB = """stoptime=1
music_timestep=0.002
strict=true
ros=2
[eye]
np=1
binary=ros_event_sensor_adapter
ros_topic=/dvs/events
message_type=event_camera_msgs/EventPacket
roi=100,60,128,128
downsample=4
polarity=split
latency=0.03
refractory=1 ms
[brain]
np=1
binary=linear_decoder
tau=0.03
[go]
np=1
binary=ros_command_adapter
ros_topic=/go
eye.out -> brain.in [2048]
brain.out -> go.in [2048]
"""
EYE = """  eye:
    node: ros_event_sensor
    topic: /dvs/events
    message: event_camera_msgs/EventPacket
    polarity: split
    downsample: 4
    roi: [100, 60, 128, 128]
    latency: 30 ms
    refractory: 1 ms
"""
USUAL = """[eye]
np=1
binary=ros_event_sensor_adapter
ros_topic=/dvs/events
[brain]
np=1
binary=linear_decoder
eye.out -> brain.in [48]
"""


def call(folder, *words):
    return runs.spikeloop(*words, cwd=folder)[0]


def eye_of(text):
    return text[text.index("  eye:\n"):text.index("  brain:\n")]


def main():
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        (folder / "job.music").write_text(JOB)
        call(folder, "import", "job.music", "--out", "first.yaml")
        first = (folder / "first.yaml").read_text()
        assert eye_of(first) == EYE and "\nros: 2\n" in first, first
        call(folder, "check", "first.yaml")
        call(folder, "export", "first.yaml", "--out", "job")
        job = next((folder / "job").glob("*.music"))
        call(folder, "check", str(job))
        call(folder, "import", str(job), "--out", "second.yaml")
        assert eye_of((folder / "second.yaml").read_text()) == EYE
        # What the file does not say is the program's own.
        (folder / "usual.music").write_text(USUAL)
        usual = call(folder, "import", "usual.music")
        assert eye_of(usual) == ("  eye:\n    node: ros_event_sensor\n    topic: /dvs/events\n"
                                 "    message: dvs_msgs/EventArray\n"), usual
        graph = call(folder, "graph", "first.yaml")
        assert "ros_event_sensor" in graph and "/dvs/events" in graph, graph
    print("the same files in both directions")


if __name__ == "__main__":
    sys.exit(main())
