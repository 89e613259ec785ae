#!/usr/bin/python3
import pathlib

import spikeloop.nest
import nest

import hundred_neurons

with spikeloop.nest.music(spikes_in={"in": 40}, spikes_out={"out": 100},
                          model="iaf_psc_exp") as host:
    nest.resolution = hundred_neurons.RESOLUTION_MS
    neurons = hundred_neurons.build_in_nest(nest, host.parameters["model"], host.input("in"),
                                            pathlib.Path(host.directory))
    host.output("out", neurons)
    host.run()
