"""The network of hundred_neurons.py in Brian2, on NEST's grid, with exact integration.

    hundred_in_brian.py SPIKES.npy DURATION_MS MODEL...

Writes (times in ns, neurons) to MODEL.npy. Brian2's step at t covers (t, t + dt]: its events at t are those
of the grid point t + dt. NEST holds a neuron for k steps behind the one in which it fires, and Brian2 lets it
go at its time plus the refractory period, which is a step longer therefore. Jumps of the potential come
before the threshold, as in NEST, so spikes reach the synapses a step later, which their delays make good.
"""

import sys

import hundred_neurons
import numpy as np

# Brian2 works without these; to import them takes half of its start.
sys.modules.update(dict.fromkeys(("Cython", "matplotlib", "pytest")))
import brian2  # noqa: E402
from brian2 import ms  # noqa: E402

dt_ms = hundred_neurons.RESOLUTION_MS
step_ns = round(dt_ms * 1e6)


def fired(model, times_ns, channels, duration_ms):
    exponential = model == "iaf_psc_exp"
    network = brian2.Network()
    p = hundred_neurons.PARAMETERS[model]
    if not exponential:
        network.schedule = ["start", "groups", "synapses", "thresholds", "resets", "end"]
    later_ms = 0.0 if exponential else -dt_ms
    source = brian2.SpikeGeneratorGroup(hundred_neurons.CHANNELS, channels,
                                        (-(-times_ns // step_ns) - 1) * dt_ms * ms)
    # Whole numbers in the equations, and one group: with names, SymPy takes seconds to solve them.
    equations = ("dv/dt = (({E_L:g} - v) / {tau_m:g} + ({I_e:g} + synaptic) / {C_m:g}) / ms : 1"
                 " (unless refractory)")
    equations = equations.replace("synaptic", "i_ex + i_in" if exponential else "0")
    if exponential:
        equations += ("\ndi_ex/dt = -i_ex / ({tau_syn_ex:g} * ms) : 1"
                      "\ndi_in/dt = -i_in / ({tau_syn_in:g} * ms) : 1")
    neurons = brian2.NeuronGroup(hundred_neurons.NEURONS, equations.format(**p), threshold="v >= V_th",
                                 reset="v = V_reset", refractory=(p["t_ref"] + dt_ms) * ms,
                                 method="exact",
                                 namespace={"V_th": p["V_th"], "V_reset": p["V_reset"]})
    neurons.v = p["E_L"]
    cells, begin = {"input": source}, 0
    for name, size in hundred_neurons.POPULATIONS.items():
        cells[name] = neurons[begin:begin + size]
        begin += size
    monitor = brian2.SpikeMonitor(neurons)
    network.add(source, neurons, monitor)
    for pre, post, delay_ms in hundred_neurons.PROJECTIONS:
        table = hundred_neurons.weights(model, pre, post)
        where = "v_post += w * int(not_refractory_post)"
        if exponential:
            where = "i_in_post += w" if pre == "inhibitory" else "i_ex_post += w"
        synapses = brian2.Synapses(cells[pre], cells[post], "w : 1", on_pre=where)
        targets, sources = np.nonzero(table)
        synapses.connect(i=sources, j=targets)
        synapses.w = table[targets, sources]
        synapses.delay = (delay_ms + later_ms) * ms
        network.add(synapses)
    network.run(duration_ms * ms)
    steps = np.rint(monitor.t_[:] / (dt_ms * 1e-3)).astype(np.int64)
    return np.stack([(steps + 1) * step_ns, monitor.i[:]])


brian2.prefs.codegen.target = "numpy"
brian2.defaultclock.dt = dt_ms * ms
for each in sys.argv[3:]:
    np.save(f"{each}.npy", fired(each, *np.load(sys.argv[1]), float(sys.argv[2])))
