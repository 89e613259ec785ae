import numpy as np
import spikeloop

CENTRE = np.array([0, 0.38])  # m
DISTANCE = 0.1


@spikeloop.node(outputs={"out": spikeloop.Signal(width=2)})
def targets(step):
    """Centre-out: eight targets in turn, each for a second, with a second at the centre between (m)"""
    second = step.end // spikeloop.SECOND
    angle = np.pi / 4 * (second // 2)
    out = DISTANCE * np.array([np.cos(angle), np.sin(angle)])
    step.write("out", CENTRE + (second % 2) * out)
