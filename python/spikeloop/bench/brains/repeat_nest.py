#!/usr/bin/python3
"""A parrot neuron of NEST's a channel, which repeats every spike after a tick."""
import spikeloop.nest
import nest

with spikeloop.nest.music(spikes_in={"in": None}, spikes_out={"out": None}) as host:
    tick_ms = host.tick_s * 1e3
    nest.resolution = min(1.0, tick_ms)
    parrots = nest.Create("parrot_neuron", host.widths["in"])
    # NEST's tick is its shortest delay.
    nest.Connect(host.input("in"), parrots, "one_to_one", {"delay": tick_ms})
    host.output("out", parrots)
    host.run()
