"""The network of integrate_brian.py without MUSIC, from a SpikeGeneratorGroup that knows all spikes
before the run. Writes (number of the step, neuron) of what it fires.

    brian_alone.py SENT.npy DURATION_MS STEP_NS FIRED.npy
"""

import sys

import numpy as np
from brian2 import SpikeGeneratorGroup, SpikeMonitor, defaultclock, ms, prefs, second

sys.path.insert(0, "scripts")
from brian_network import network_of

prefs.codegen.target = "numpy"
times_ns, channels = np.load(sys.argv[1])
step_ns = int(sys.argv[3])
# Brian2's step at t covers (t, t + dt].
begins = (-(-times_ns // step_ns) - 1) * step_ns
source = SpikeGeneratorGroup(int(channels.max()) + 1, channels, begins * 1e-9 * second)
network, cells = network_of(source)
monitor = SpikeMonitor(cells)
network.add(monitor)
network.run(float(sys.argv[2]) * ms)
np.save(sys.argv[4], np.stack([np.rint(monitor.t_[:] / defaultclock.dt_), monitor.i[:]]))
