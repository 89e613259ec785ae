#!/usr/bin/python3
"""brain.yaml for NEST with MUSIC. Not run by our tests: Debian has no NEST."""

import nest
from mpi4py import MPI

nest.resolution = 0.1  # ms
sensor = nest.Create("music_event_in_proxy", 20, [{"port_name": "in", "music_channel": channel}
                                                  for channel in range(20)])
nest.SetAcceptableLatency("in", 1.0)  # ms: the tick
relay = nest.Create("parrot_neuron", 20)
bias = nest.Create("iaf_psc_delta", 1, {"I_e": 500.0})  # pA
motor = nest.Create("music_event_out_proxy", 1, {"port_name": "out"})

nest.Connect(sensor, relay, "one_to_one", {"delay": 1.0})
for channel, neuron in enumerate(relay + bias):
    nest.Connect(neuron, motor, "one_to_one", {"music_channel": channel})

MPI.COMM_WORLD.Barrier()  # once, as every program of the job
nest.Simulate(6000.0)  # ms
