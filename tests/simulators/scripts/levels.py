#!/usr/bin/python3
"""Continuous ports, and spikes that are answered in the tick in which they are seen."""
import numpy as np
import spikeloop

seen = []
with spikeloop.music(spikes_in={"in": None}, spikes_out={"out": None}, signals_in={"level": 3},
                     signals_out={"half": 3}) as host:
    for tick in host:
        times, channels = tick.spikes("in")
        seen.append(np.stack([times, channels, np.full(len(times), tick.begin_s)]))
        tick.send("out", np.full(len(times), tick.end_s), channels)
        level = tick.signal("level")
        if level is not None:
            tick.write("half", level / 2)
np.save("seen.npy", np.concatenate(seen, axis=1))
