"""A cell of two sections, for the script and for the run without MUSIC."""
import types


def ball_and_stick(h):
    soma, dendrite = h.Section(name="soma"), h.Section(name="dendrite")
    soma.L = soma.diam = 20
    dendrite.L, dendrite.diam, dendrite.nseg = 200, 2, 5
    dendrite.connect(soma(1))
    soma.insert("hh")
    dendrite.insert("pas")
    for segment in dendrite:
        segment.pas.g, segment.pas.e = 1e-4, -65
    synapse = h.ExpSyn(dendrite(0.7))
    synapse.tau = 2
    return types.SimpleNamespace(soma=soma, dendrite=dendrite, synapse=synapse)
