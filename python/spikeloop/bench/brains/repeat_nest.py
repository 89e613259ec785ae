#!/usr/bin/python3
"""A parrot neuron of NEST's a channel, between MUSIC's proxies; nest.json says how many."""
import json
import os
import sys
import traceback

import nest


def end(*error):
    """Without it, a script that fails leaves the job waiting for ever."""
    traceback.print_exception(*error)
    os._exit(1)


sys.excepthook = end
with open("nest.json", encoding="utf-8") as file:
    given = json.load(file)
neurons, tick_ms = given["neurons"], given["tick_ms"]
nest.set_verbosity("M_ERROR")
nest.SetKernelStatus({"resolution": given["resolution_ms"]})
# NEST's tick is its shortest delay: that of all connections.
nest.SetKernelStatus({"min_delay": tick_ms, "max_delay": tick_ms})
sources = nest.Create("music_event_in_proxy", neurons,
                      [{"port_name": "in", "music_channel": channel} for channel in range(neurons)])
parrots = nest.Create("parrot_neuron", neurons)
sink = nest.Create("music_event_out_proxy", 1, {"port_name": "out"})
nest.Connect(sources, parrots, "one_to_one", {"delay": tick_ms})
for channel in range(neurons):
    nest.Connect(parrots[channel], sink, "one_to_one",
                 {"music_channel": channel, "delay": tick_ms})
nest.SetAcceptableLatency("in", 0.001)  # ms: NEST rounds times to it, and may round them down
nest.SetMaxBuffered("in", 1)
nest.Simulate(given["duration_ms"])
