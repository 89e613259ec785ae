#!/usr/bin/python3
"""Keeps a signal, tick by tick."""
import numpy as np
import spikeloop

rows = []
with spikeloop.music(signals_in={"voltage": 2}) as host:
    for tick in host:
        values = tick.signal("voltage")
        rows.append([np.nan] * 2 if values is None else values)
np.save("rows.npy", rows)
