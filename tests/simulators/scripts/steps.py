#!/usr/bin/python3
"""A signal that is another one in every tick."""
import numpy as np
import spikeloop

with spikeloop.music(signals_out={"level": 2}) as host:
    for number, tick in enumerate(host):
        tick.write("level", np.array([1.0, -2.0]) * (number + 1))
