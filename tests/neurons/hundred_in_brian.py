"""The network of hundred_neurons.py in Brian2, on NEST's grid, with exact integration.

    hundred_in_brian.py MODEL SPIKES.npy DURATION_MS FIRED.npy        in the folder of the weights

Writes (times in ns, neurons). Brian2's step at t covers (t, t + dt]: its events at t are those of the
grid point t + dt. NEST holds a neuron for k steps behind the one in which it fires, and Brian2 lets it go
at its time plus the refractory period, which is a step longer therefore. Jumps of the potential come before the threshold, as in NEST, so spikes reach
the synapses a step later, which their delays make good.
"""

import sys

import brian2
import hundred_neurons
import numpy as np
from brian2 import ms

model, spikes, duration_ms, fired = sys.argv[1:]
brian2.prefs.codegen.target = "numpy"
dt_ms = hundred_neurons.RESOLUTION_MS
brian2.defaultclock.dt = dt_ms * ms
exponential = model == "iaf_psc_exp"
network = brian2.Network()
p = hundred_neurons.PARAMETERS[model]
if not exponential:
    network.schedule = ["start", "groups", "synapses", "thresholds", "resets", "end"]
later_ms = 0.0 if exponential else -dt_ms

step_ns = round(dt_ms * 1e6)
times_ns, channels = np.load(spikes)
source = brian2.SpikeGeneratorGroup(hundred_neurons.CHANNELS, channels,
                                    (-(-times_ns // step_ns) - 1) * dt_ms * ms)
names = {"tau": p["tau_m"] * ms, "E_L": p["E_L"], "I_e": p["I_e"], "C": p["C_m"],
         "V_th": p["V_th"], "V_reset": p["V_reset"]}
equations = "dv/dt = (E_L - v) / tau + (I_e + synaptic) / (C * ms) : 1 (unless refractory)"
equations = equations.replace("synaptic", "i_ex + i_in" if exponential else "0")
if exponential:
    names.update(tau_ex=p["tau_syn_ex"] * ms, tau_in=p["tau_syn_in"] * ms)
    equations += "\ndi_ex/dt = -i_ex / tau_ex : 1\ndi_in/dt = -i_in / tau_in : 1"
cells = {"input": source}
monitors = []
for name, size in hundred_neurons.POPULATIONS.items():
    group = brian2.NeuronGroup(size, equations, threshold="v >= V_th", reset="v = V_reset",
                               refractory=(p["t_ref"] + dt_ms) * ms, method="exact",
                               namespace=names)
    group.v = p["E_L"]
    cells[name] = group
    monitors.append(brian2.SpikeMonitor(group))
network.add(*cells.values(), *monitors)
for pre, post, delay_ms in hundred_neurons.PROJECTIONS:
    table = np.load(f"{pre}_{post}.npy")
    where = "v_post += w * int(not_refractory_post)"
    if exponential:
        where = "i_in_post += w" if pre == "inhibitory" else "i_ex_post += w"
    synapses = brian2.Synapses(cells[pre], cells[post], "w : 1", on_pre=where)
    targets, sources = np.nonzero(table)
    synapses.connect(i=sources, j=targets)
    synapses.w = table[targets, sources]
    synapses.delay = (delay_ms + later_ms) * ms
    network.add(synapses)
network.run(float(duration_ms) * ms)
first = np.cumsum([0, *hundred_neurons.POPULATIONS.values()])
np.save(fired, np.concatenate([
    np.stack([(np.rint(monitor.t_[:] / (dt_ms * 1e-3)).astype(np.int64) + 1) * step_ns,
              monitor.i[:] + begin])
    for monitor, begin in zip(monitors, first)], axis=1))
