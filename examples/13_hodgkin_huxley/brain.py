"""Ten Hodgkin-Huxley cells in NEURON, one a sector of the view: each has a dendrite with a synapse."""
import spikeloop.neuron
from neuron import h


class Cell:
    def __init__(self):
        self.soma, self.dendrite = h.Section(name="soma"), h.Section(name="dendrite")
        self.soma.L = self.soma.diam = 20
        self.dendrite.L, self.dendrite.diam, self.dendrite.nseg = 100, 2, 3
        self.dendrite.connect(self.soma(1))
        self.soma.insert("hh")
        self.dendrite.insert("pas")
        self.dendrite.e_pas = -65
        self.synapse = h.ExpSyn(self.dendrite(0.5))
        self.synapse.tau = 2


with spikeloop.neuron.music(spikes_in={"in": None}, spikes_out={"out": None},
                            weight=0.05) as host:
    cells = [Cell() for _ in range(host.widths["in"])]
    for channel, cell in enumerate(cells):
        host.connect_input("in", channel, cell.synapse, weight=host.parameters["weight"],
                           delay_ms=1)
        host.connect_output("out", channel, cell.soma(0.5)._ref_v, sec=cell.soma, threshold_mV=0)
    host.run(v_init_mV=-65)
