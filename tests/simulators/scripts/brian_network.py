"""A network of Brian2's, for the script and for the run without MUSIC. To be imported before Brian2."""
import sys

# Brian2 works without these; to import them takes half of its start.
sys.modules.update(dict.fromkeys(("Cython", "matplotlib", "pytest")))
from brian2 import Network, NeuronGroup, Synapses, ms, nS, mV, pF, pA  # noqa: E402, F401

EQUATIONS = """
dv/dt = (-70*mV - v) / (15*ms) + (g * (0*mV - v)) / (200*pF) : volt (unless refractory)
dg/dt = -g / (3*ms) : siemens
"""


def network_of(source):
    cells = NeuronGroup(20, EQUATIONS, threshold="v > -52*mV", reset="v = -65*mV",
                        refractory=2 * ms, method="rk4")
    cells.v = "-70*mV + i * 0.4*mV"
    forward = Synapses(source, cells, on_pre="g_post += 5*nS", delay=1.3 * ms)
    forward.connect("(i + 3 * j) % 7 < 3")
    back = Synapses(cells, cells, on_pre="g_post += 0.8*nS", delay=0.5 * ms)
    back.connect("i != j and (i * j) % 3 == 1")
    return Network(source, cells, forward, back), cells
