#!/usr/bin/python3
import spikeloop.nest
import nest

with spikeloop.nest.music(spikes_in={"in": None}, spikes_out={"out": None},
                          resolution=0.1, delay=0.0) as host:
    nest.resolution = host.parameters["resolution"]
    delay = host.parameters["delay"] or host.tick_s * 1e3
    cells = nest.Create("parrot_neuron", host.widths["in"])
    nest.Connect(host.input("in"), cells, "one_to_one", {"delay": delay})
    host.output("out", cells)
    host.run()
