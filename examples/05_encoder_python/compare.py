"""Compares two encoders' spikes in a run folder:  compare.py FOLDER NODE NODE

Exit code 1 when they are more than a nanosecond apart.
"""

import sys

import numpy as np
from spikeloop.run_folder import RunFolder


def in_order(label):
    """Times in s, sorted by channel and time, and the number of spikes of each channel."""
    (spikes,) = run.spikes(label)
    order = np.lexsort((spikes.times_s, spikes.channels))
    return spikes.times_s[order], np.bincount(spikes.channels, minlength=spikes.width)


run = RunFolder(sys.argv[1])
(first, counts), (second, other_counts) = in_order(sys.argv[2]), in_order(sys.argv[3])
if np.any(counts != other_counts) or not np.all(counts):
    sys.exit(f"{counts} spikes of each channel, and {other_counts}")
apart = np.abs(first - second).max() * 1e9
print(f"{len(first)} spikes of {len(counts)} channels, at most {apart:.1f} ns apart")
sys.exit(bool(apart > 1.001))
