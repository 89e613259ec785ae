#!/usr/bin/python3
"""brain.yaml in NEST's words: for NEST with MUSIC, or without."""
import spikeloop.nest
import nest

with spikeloop.nest.music(spikes_in={"in": 20}, spikes_out={"out": 21}) as host:
    nest.resolution = 0.1  # ms
    relay = nest.Create("parrot_neuron", 20)
    bias = nest.Create("iaf_psc_delta", 1, {"I_e": 500.0})  # pA
    nest.Connect(host.input("in"), relay, "one_to_one", {"delay": 1.0})
    host.output("out", relay + bias)
    host.run()
