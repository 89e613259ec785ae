"""The network of hundred_neurons.py in NEST alone: a spike_generator a channel that knows all spikes
before the run, which is one nest.Simulate. Writes (times in ns, neurons from 0) of what it fires.

    hundred_nest_alone.py MODEL SPIKES.npy DURATION_MS FIRED.npy     in the folder of the weights
"""

import pathlib
import sys

import nest
import numpy as np

import hundred_neurons

model, spikes, duration_ms, fired = sys.argv[1:]
nest.set_verbosity("M_ERROR")
nest.resolution = hundred_neurons.RESOLUTION_MS
times_ns, channels = np.load(spikes)
# Rounded up to the grid by whole numbers.
step_ns = round(hundred_neurons.RESOLUTION_MS * 1e6)
times_ms = -(-times_ns // step_ns) * step_ns / 1e6
source = nest.Create("spike_generator", hundred_neurons.CHANNELS)
for channel, node in enumerate(source):
    node.spike_times = np.sort(times_ms[channels == channel])
neurons = hundred_neurons.build_in_nest(nest, model, source, pathlib.Path("."))
recorder = nest.Create("spike_recorder", params={"time_in_steps": True})
nest.Connect(neurons, recorder)
nest.Simulate(float(duration_ms))
events = recorder.get("events")
np.save(fired, np.stack([events["times"] * step_ns, events["senders"] - neurons[0].global_id]))
