"""The network of hundred_neurons.py in NEURON: IntFire1, which is solved exactly between events.

    hundred_in_neuron.py TASK.json SPIKES.npy DURATION_MS FIRED.npy   in the folder of the weights

Potentials in units of the way from rest to threshold; no constant current. Writes (times in ns,
neurons).
"""

import json
import sys

import hundred_neurons
import numpy as np
from neuron import h

task = json.load(open(sys.argv[1], encoding="utf-8"))
p = task["parameters"]
way = p["V_th"] - p["E_L"]
cells, recorded = [], h.Vector()
numbers = h.Vector()
context = h.ParallelContext()
for number in range(hundred_neurons.NEURONS):
    cell = h.IntFire1()
    cell.tau, cell.refrac = p["tau_m"], p["t_ref"]
    context.set_gid2node(number, 0)
    context.cell(number, h.NetCon(cell, None))
    context.spike_record(number, recorded, numbers)
    cells.append(cell)
times_ns, channels = np.load(sys.argv[2])
first = dict(zip(hundred_neurons.POPULATIONS,
                 np.cumsum([0, *hundred_neurons.POPULATIONS.values()])))
links, driven = [], []
for pre, post, delay_ms in task["projections"]:
    table = np.load(f"{pre}_{post}.npy")
    for target, source in zip(*np.nonzero(table)):
        node = None if pre == "input" else cells[first[pre] + source]
        link = h.NetCon(node, cells[first[post] + target])
        link.delay, link.weight[0] = delay_ms, task["factor"] * table[target, source] / way
        links.append(link)
        if pre == "input":
            driven.append((link, (times_ns[channels == source] / 1e6 + delay_ms)))


def drive():
    """Events cannot be queued before the run has begun."""
    for link, times in driven:
        for time in times:
            link.event(time)


handler = h.FInitializeHandler(drive)
h.CVode().active(task["variable"])
h.finitialize(0)
context.set_maxstep(10)
context.psolve(float(sys.argv[3]))
np.save(sys.argv[4], np.stack([np.rint(np.array(recorded) * 1e6).astype(np.int64),
                               np.array(numbers).astype(np.int64)]))
