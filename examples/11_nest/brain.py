#!/usr/bin/python3
"""A hundred leaky integrate-and-fire neurons between a laser and two wheels, in NEST."""
import spikeloop.nest
import nest

with spikeloop.nest.music(spikes_in={"in": 100}, spikes_out={"out": 100}) as host:
    nest.resolution = 0.1
    neurons = nest.Create("iaf_psc_delta", 100, {"t_ref": 2.0})
    # 20 mV, from rest to above the threshold: a spike a spike.
    nest.Connect(host.input("in"), neurons, "one_to_one", {"weight": 20.0, "delay": 1.0})
    host.output("out", neurons)
    host.run()
