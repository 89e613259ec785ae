"""Nodes written in Python, and readers and pictures of what a run of Spikeloop leaves on disk.

    import spikeloop

    @spikeloop.node(inputs={"in": "signal"}, outputs={"out": "signal"}, gain=2.0)
    def gain(step, gain):
        \"\"\"Multiplies its input\"\"\"
        if step.changed("in"):
            step.write("out", gain * step.inputs["in"])

`node`, `Signal`, `Spikes`, `Parameter` and `Weights` declare a node; `spikeloop.steps.Step` is what
it sees; `spikeloop.testing` runs one without the C++ programs. `spikeloop.run_folder` reads a run,
`spikeloop.plots` draws it; these two are imported by name, because h5py and matplotlib are slow.
"""

from .declare import NodeError, Parameter, SECOND, Signal, Spikes, Weights, node

__all__ = ["NodeError", "Parameter", "SECOND", "Signal", "Spikes", "Weights", "node"]
