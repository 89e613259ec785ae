"""Tells and draws what the synapses have learnt:  weights.py WEIGHTS.npy PICTURE"""
import sys

import numpy as np
from spikeloop import style

weights = np.load(sys.argv[1])
together, alone = weights[:, :10], weights[:, 10:]
for second in (0, 4, 9, 14, 19):
    print(f"after {second + 1:2} s: {together[second].mean():5.1f} pA where spikes come together, "
          f"{alone[second].mean():5.1f} pA where they do not")
with style.styled():
    figure = style.new_figure(7, 4)
    axes = figure.subplots()
    seconds = np.arange(1, len(weights) + 1)
    axes.plot(seconds, together, color=style.VERMILLION, lw=1)
    axes.plot(seconds, alone, color=style.BLUE, lw=1)
    axes.set(title="Synapses of spikes that come together (red), and of others (blue)",
             xlabel="time (s)", ylabel="weight (pA)")
    style.save(figure, sys.argv[2])
