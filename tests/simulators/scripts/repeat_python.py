#!/usr/bin/python3
import spikeloop

with spikeloop.music(spikes_in={"in": None}, spikes_out={"out": None}) as host:
    for tick in host:
        tick.send("out", *tick.spikes("in"))
