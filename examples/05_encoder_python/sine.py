import numpy as np
import spikeloop


@spikeloop.node(outputs={"out": "signal"}, frequency=spikeloop.Parameter(1, unit="Hz", minimum=0))
def sine(step, frequency):
    """Sine waves, each channel a bit later than the one before"""
    phase = np.arange(step.width("out")) / step.width("out")
    step.write("out", np.sin(2 * np.pi * (frequency * step.end / spikeloop.SECOND - phase)))
