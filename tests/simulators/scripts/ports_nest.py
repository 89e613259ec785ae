#!/usr/bin/python3
"""A signal is the current of two neurons, whose potentials are another signal."""
import numpy as np
import spikeloop.nest
import nest

seen = []
with spikeloop.nest.music(signals_in={"level": 2}, signals_out={"voltage": 2}) as host:
    neurons = nest.Create("iaf_psc_exp", 2, {"V_th": 1000.0})
    host.record("voltage", neurons, "V_m")
    for tick in host:
        level = tick.signal("level")
        seen.append([np.nan] * 2 if level is None else level)
        if level is not None:
            neurons.I_e = level
        host.advance(tick)
np.save("seen.npy", seen)
