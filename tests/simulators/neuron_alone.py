"""The cell of hodgkin_huxley.py without MUSIC: all spikes are known before the run, which is one
h.continuerun(). Prints the times in ms of what the cell fires.

    neuron_alone.py SENT.npy DURATION_MS CVODE
"""

import sys

import numpy as np
from neuron import h

sys.path.insert(0, "scripts")
from ball_and_stick import ball_and_stick

h.load_file("stdrun.hoc")
sent_ms = np.load(sys.argv[1]) / 1e6
cell = ball_and_stick(h)
connection = h.NetCon(None, cell.synapse)
connection.weight[0] = 0.004
initialize = h.FInitializeHandler(lambda: [connection.event(t + 0.7) for t in sent_ms])
fired = h.Vector()
detector = h.NetCon(cell.soma(0.5)._ref_v, None, sec=cell.soma)
detector.threshold = 0
detector.record(fired)
if sys.argv[3] == "True":
    h.CVode().active(True)
    h.CVode().atol(1e-9)
    h.CVode().condition_order(2)
h.finitialize(-65)
h.continuerun(float(sys.argv[2]))
print(" ".join(repr(t) for t in fired))
