#!/usr/bin/python3
"""Every wrong call, one after the other; prints what is said of it."""
import numpy as np
import spikeloop


def refused(call, *arguments, **named):
    try:
        call(*arguments, **named)
        print("REFUSED NOTHING")
    except spikeloop.NodeError as error:
        print("REFUSED", error)


refused(spikeloop.music)
refused(spikeloop.music, spikes_in=["in"])
refused(spikeloop.music, spikes_in={"in": 0})
refused(spikeloop.music, spikes_in={"in": 2}, signals_out={"in": 2})
refused(spikeloop.music, spikes_in={3: 2})
refused(spikeloop.music, spikes_in={"in": 2}, weights=spikeloop.Weights())
refused(spikeloop.music, spikes_in={"in": 2}, spikes_ou={"out": 10})
refused(spikeloop.music, spikes_in={"in": 2}, gain=[1])
with spikeloop.music(spikes_in={"in": None}, spikes_out={"out": None}, signals_in={"image": 3},
                     signals_out={"level": 2}) as host:
    refused(spikeloop.music, spikes_in={"in": 2})
    first = None
    for tick in host:
        if first is not None:
            refused(first.spikes, "in")
            first = None
        if tick.begin_ns != 10_000_000:
            continue
        first = tick
        refused(tick.spikes, "inn")
        refused(tick.spikes, "image")
        refused(tick.send, "in", 0.0105, 0)
        refused(tick.send, "out", [0.0105, np.nan], [0, 0])
        refused(tick.send, "out", 0.010, 0)
        refused(tick.send, "out", 0.011000001, 0)
        refused(tick.send, "out", 0.0105, 5)
        refused(tick.send, "out", 0.0105, -1)
        refused(tick.send, "out", [0.0105, 0.0106], [0, 1, 2])
        refused(tick.send, "out", 0.0105, 0.5)
        refused(tick.send, "out", ["now"], [0])
        refused(tick.send, "out", [[0.0105]], [[0]])
        refused(tick.write, "level", [1, 2, 3])
        refused(tick.write, "level", ["a", "b"])
        print("image", tick.signal("image"))
        tick.send("out", [], [])
        tick.send("out", [0.0110, 0.0105], 1)
    refused(iter(host).__next__)
