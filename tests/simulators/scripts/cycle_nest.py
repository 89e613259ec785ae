#!/usr/bin/python3
import spikeloop.nest
import nest

with spikeloop.nest.music(spikes_in={"in": 1, "back": 1}, spikes_out={"out": 1}) as host:
    cell = nest.Create("parrot_neuron")
    nest.Connect(host.input("in"), cell, syn_spec={"delay": 1.0})
    nest.Connect(host.input("back"), cell, syn_spec={"delay": 3.0})
    host.output("out", cell)
    host.run()
