"""Learning synapses in NEST alone: the same trains, pairs and parameters as the built-in network has.

    nest_stdp_alone.py TASK.json WEIGHTS.npy

The task: resolution_ms, delay_ms, teach_ms, weight, model, parameters of the synapse, tau_minus, trains
`pre`, `post` and perhaps `dopamine`, in ms. Writes weights [targets, sources].
"""

import json
import sys

import nest
import numpy as np

task = json.load(open(sys.argv[1], encoding="utf-8"))
nest.set_verbosity("M_ERROR")
nest.resolution = task["resolution_ms"]


def generators(trains, earlier_ms):
    """Spikes that are at their parrots, or cells, `earlier_ms` later."""
    nodes = nest.Create("spike_generator", len(trains))
    for node, train in zip(nodes, trains):
        node.spike_times = [round(time - earlier_ms, 4) for time in train]
    return nodes


def parrots(trains):
    # NEST takes spikes to learning synapses once in the shortest delay. A volume_transmitter has
    # brought these up to its end by then, and goes back over what lies between: right to the grid
    # when that delay is one step.
    nodes = nest.Create("parrot_neuron", len(trains))
    delay = task["resolution_ms"]
    nest.Connect(generators(trains, delay), nodes, "one_to_one", {"delay": delay})
    return nodes


sources = parrots(task["pre"])
cells = nest.Create("iaf_psc_delta", len(task["post"]),
                    {"t_ref": 0.0, "V_th": 1000.0, "tau_minus": task["tau_minus"]})
nest.Connect(generators(task["post"], 0.0), cells, "one_to_one",
             {"weight": 1e6, "delay": task["teach_ms"]})
parameters = dict(task["parameters"])
if "dopamine" in task:
    transmitter = nest.Create("volume_transmitter")
    nest.Connect(parrots([task["dopamine"]]), transmitter,
                 syn_spec={"delay": task["reward_delay_ms"]})
    parameters["volume_transmitter"] = transmitter
nest.CopyModel(task["model"], "learning", {**parameters, "weight": task["weight"]})
nest.Connect(sources, cells, "all_to_all",
             {"synapse_model": "learning", "delay": task["delay_ms"]})
nest.Simulate(task["duration_ms"])
weights = np.zeros((len(cells), len(sources)))
for link in nest.GetConnections(sources, cells):
    weights[link.target - cells[0].global_id, link.source - sources[0].global_id] = link.weight
np.save(sys.argv[2], weights)
