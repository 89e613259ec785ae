"""rates.py RUN: spikes that went into the model and came out of it, a line a channel."""
import sys

import h5py
import numpy as np

counts = []
for name in ("encoder", "brain"):
    with h5py.File(f"{sys.argv[1]}/{name}.h5") as file:
        channels = file["spikes/out/node_ids"][:].astype(int)
    counts.append(np.bincount(channels, minlength=10))
for channel, (sent, answered) in enumerate(zip(*counts)):
    print(f"channel {channel}: {sent:4} in, {answered:4} out")
