"""How much the mean rate of some neurons fluctuates, filtered as in the decoder.

    /usr/bin/python3 ripple.py RUN FIRST LAST

FIRST and LAST are channels of the network's output.
"""
import sys

import numpy as np
from spikeloop.run_folder import RunFolder

TAU_S, TICK_S = 0.05, 0.001  # of the decoder, and of the run
BEGIN_S, END_S, MEAN_S = 2, 10, 0.4


def filtered_rate(spikes, first, last):
    """Hz, once a tick."""
    mine = (spikes.channels >= first) & (spikes.channels <= last)
    counts = np.bincount((spikes.times_s[mine] / TICK_S).astype(int), minlength=round(END_S / TICK_S))
    kernel = np.exp(-np.arange(0, 10 * TAU_S, TICK_S) / TAU_S) / TAU_S
    return np.convolve(counts, kernel)[:len(counts)] / (last - first + 1)


rate = filtered_rate(RunFolder(sys.argv[1])["brain"].spikes, int(sys.argv[2]), int(sys.argv[3]))
window = round(MEAN_S / TICK_S)
slow = np.convolve(rate, np.full(window, 1 / window), "same")  # what the vehicle sees changes, too
shown = slice(round(BEGIN_S / TICK_S), round(END_S / TICK_S))
print(f"{rate[shown].mean():.1f} Hz, fluctuates by {np.std((rate - slow)[shown]):.1f} Hz")
