#!/usr/bin/python3
"""A bag of an event camera in the robot's place: every event is a spike of its channel and at its time,
to the nanosecond, in every encoding and whatever is taken of the picture."""

import pathlib
import re
import sys
import tempfile

import genpy
import rosbag

import camera
import runs

EXPERIMENT = """experiment: events
sync: unpaced
robot: {{bag: {bag}}}
nodes:
  eye: {{node: ros_event_sensor, topic: /events, message: {message}, {keys}}}
  relay:
    simulator: builtin
    network:
      populations: {{in: {{model: input, size: {width}}}, out: {{model: repeater, size: {width}}}}}
      connections: [{{from: in, to: out, rule: one_to_one, delay: 1 ms}}]
      output: [out]
connections:
  - eye -> relay{width_of_eye}
"""
PERIOD_NS = 10_000_000
LATENCY_NS = 15_000_000


def write_bag(path, type_, messages):
    """A message every 10 ms, with the sum that `spikeloop describe` tells: genpy says the same
    (tests/messages/event_oracle_test.cpp)."""
    text, _ = runs.spikeloop("describe", type_)
    assert type_ in text, text
    md5 = re.search(r"\b[0-9a-f]{32}\b", text)[0]
    class_ = type("Message", (), {"_type": type_, "_md5sum": md5, "_full_text": "none"})
    with rosbag.Bag(path, "w") as bag:
        for i, data in enumerate(messages):
            bag.write("/events", (type_, data, md5, class_), genpy.Time(1000, i * PERIOD_NS), raw=True)


def recorded(folder):
    times, channels = runs.recordings.spikes(folder, "eye")
    return sorted(zip(times.tolist(), channels.tolist()))


def expected(messages, channel_of):
    """The newest event of the first message is that of time 0, and everything is sent LATENCY_NS later."""
    newest = 1000 * max(us for us, *_ in messages[0])
    return sorted((stamp - newest + LATENCY_NS, channel)
                  for stamp, channel in camera.spikes(messages, channel_of))


def main():
    seen = 0
    cases = [(encoding, "", 48, camera.whole) for encoding in (camera.Evt3(), camera.Evt2(),
                                                               camera.Mono(), None)]
    cases += [(camera.Evt3(), "polarity: split", 96, camera.split),
              (camera.Evt2(), "polarity: on, roi: [2, 1, 5, 4], downsample: 2", 6, camera.part)]
    for case, (encoding, keys, width, channel_of) in enumerate(cases):
        with tempfile.TemporaryDirectory() as scratch:
            scratch = pathlib.Path(scratch)
            messages = camera.film(case, 20)
            type_ = camera.ARRAY if encoding is None else camera.PACKET
            data = (camera.arrays(messages, "1") if encoding is None
                    else camera.packets(messages, encoding, "1"))
            write_bag(scratch / "events.bag", type_, data)
            file = scratch / "events.yaml"
            file.write_text(EXPERIMENT.format(
                bag="events.bag", message=type_, width=width, width_of_eye="",
                keys=", ".join(filter(None, [keys, "latency: 15 ms"]))) + "duration: 250 ms\n")
            summary, _ = runs.run(file, scratch / "run")
            want = expected(messages, channel_of)
            assert recorded(scratch / "run") == want, (case, recorded(scratch / "run")[:5], want[:5])
            counters = summary["counters"]
            assert counters["eye.messages"] == 20 and counters["eye.events"] == 500, counters
            assert counters["eye.late_events"] == 0 and counters["eye.malformed"] == 0, counters
            seen += len(want)
            # The recorded messages give the same spikes.
            runs.spikeloop("replay", scratch / "run", "--out", scratch / "again")
            assert recorded(scratch / "again") == want
    print(f"{seen} events, each at its pixel and time")


if __name__ == "__main__":
    sys.exit(main())
