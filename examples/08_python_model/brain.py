#!/usr/bin/python3
"""Leaky integrate-and-fire neurons in NumPy, exact between spikes: an example of any model."""
import numpy as np
import spikeloop

with spikeloop.music(spikes_in={"in": None}, spikes_out={"out": None},
                     tau=spikeloop.Parameter(20e-3, unit="s"), weight=0.4) as host:
    tau, weight = host.parameters["tau"], host.parameters["weight"]
    potential = np.zeros(host.widths["in"])  # 1 is the threshold
    since = np.zeros(host.widths["in"])      # when it was that
    spikes = 0
    for tick in host:
        for time, channel in zip(*tick.spikes("in")):
            decayed = potential[channel] * np.exp((since[channel] - time) / tau)
            potential[channel], since[channel] = decayed + weight, time
            if potential[channel] >= 1:
                potential[channel] = 0
                tick.send("out", time, channel)
                spikes += 1
    print(f"{spikes} spikes in {tick.end_s:g} s")
