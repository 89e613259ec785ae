#!/usr/bin/python3
"""Sends the spikes of spikes.npy: (times in ns, channels)."""
import numpy as np
import spikeloop

times, channels = np.load("spikes.npy")
with spikeloop.music(spikes_out={"out": None}) as host:
    for tick in host:
        now = (times > tick.begin_ns) & (times <= tick.end_ns)
        tick.send("out", times[now] / 1e9, channels[now])
