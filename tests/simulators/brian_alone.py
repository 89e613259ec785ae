"""The network of integrate_brian.py without MUSIC, from a SpikeGeneratorGroup that knows all spikes
before the run: those in sent.npy of each folder. Writes (number of the step, neuron) of what it fires to
fired.npy beside it.

    brian_alone.py DURATION_MS STEP_NS FOLDER...
"""

import pathlib
import sys

import numpy as np

sys.path.insert(0, "scripts")
from brian_network import network_of

from brian2 import SpikeGeneratorGroup, SpikeMonitor, defaultclock, ms, prefs, second

prefs.codegen.target = "numpy"
step_ns = int(sys.argv[2])
for folder in map(pathlib.Path, sys.argv[3:]):
    times_ns, channels = np.load(folder / "sent.npy")
    # Brian2's step at t covers (t, t + dt].
    begins = (-(-times_ns // step_ns) - 1) * step_ns
    source = SpikeGeneratorGroup(int(channels.max()) + 1, channels, begins * 1e-9 * second)
    network, cells = network_of(source)
    monitor = SpikeMonitor(cells)
    network.add(monitor)
    network.run(float(sys.argv[1]) * ms)
    np.save(folder / "fired.npy", np.stack([np.rint(monitor.t_[:] / defaultclock.dt_), monitor.i[:]]))
