"""Node classes for python_bench.cpp: as little work of their own as a node can do."""

import numpy as np
import spikeloop


@spikeloop.node(inputs={"in": "signal"}, outputs={"out": spikeloop.Signal(same_as="in")})
def bench_idle(step):
    if step.changed("in"):
        step.write("out", step.inputs["in"])


@spikeloop.node(inputs={"in": "signal"}, outputs={"out": spikeloop.Signal(same_as="in")}, gain=2.0)
def bench_gain(step, gain):
    if step.changed("in"):
        step.write("out", gain * step.inputs["in"])


@spikeloop.node(inputs={"in": "signal"}, outputs={"out": spikeloop.Spikes(same_as="in")})
def bench_threshold(step):
    step.emit("out", step.end, np.flatnonzero(step.inputs["in"] > 0.98))
