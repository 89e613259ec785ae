#!/usr/bin/python3
"""Keeps what it gets, and when."""
import numpy as np
import spikeloop

got = [np.zeros((3, 0))]
with spikeloop.music(spikes_in={"in": None}) as host:
    for tick in host:
        times, channels = tick.spikes("in")
        got.append(np.stack([times, channels, np.full(len(times), tick.begin_s)]))
np.save("got.npy", np.concatenate(got, axis=1))
