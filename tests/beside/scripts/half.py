"""Sends spikes back, and half of every value."""
import spikeloop

with spikeloop.music(spikes_in={"in": None}, spikes_out={"out": None},
                     signals_in={"level": None}, signals_out={"half": None}) as host:
    for tick in host:
        tick.send("out", *tick.spikes("in"))
        level = tick.signal("level")
        if level is not None:
            tick.write("half", 0.5 * level)
