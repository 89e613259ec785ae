#!/usr/bin/python3
"""Keeps a continuous input: a row of begin_s and the values a tick that has some."""
import numpy as np
import spikeloop

rows = []
with spikeloop.music(signals_in={"in": None}) as host:
    for tick in host:
        values = tick.signal("in")
        if values is not None:
            rows.append([tick.begin_s, *values])
np.save("levels.npy", rows)
