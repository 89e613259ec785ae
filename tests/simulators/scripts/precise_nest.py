#!/usr/bin/python3
import spikeloop.nest
import nest

with spikeloop.nest.music(spikes_in={"in": 1}, spikes_out={"out": 1}, I_e=0.0) as host:
    nest.resolution = 0.1
    neuron = nest.Create("iaf_psc_delta_ps", params={"I_e": host.parameters["I_e"], "t_ref": 2.0})
    nest.Connect(host.input("in", precise=True), neuron, syn_spec={"weight": 3.0, "delay": 1.0})
    host.output("out", neuron)
    host.run()
