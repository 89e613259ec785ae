"""Compares the spikes of the two encoders in a run folder:  compare.py FOLDER"""

import sys

import numpy as np
from spikeloop.run_folder import RunFolder

run = RunFolder(sys.argv[1])
(mine,), (built_in,) = run.spikes("encoder"), run.spikes("built_in")
apart = np.abs(mine.times_s - built_in.times_s).max() * 1e9
print(f"{len(mine.times_s)} spikes and {len(built_in.times_s)}, at most {apart:.1f} ns apart")
