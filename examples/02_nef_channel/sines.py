import numpy as np
import spikeloop


@spikeloop.node(outputs={"out": spikeloop.Signal(width=2)}, amplitude=0.7)
def sines(step, amplitude):
    """Two sine waves, of 0.3 and 0.5 Hz"""
    time_s = step.end / spikeloop.SECOND
    step.write("out", amplitude * np.sin(2 * np.pi * np.array([0.3, 0.5]) * time_s))
