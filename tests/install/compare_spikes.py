#!/usr/bin/python3
"""compare_spikes.py RUN_FOLDER A B: whether two processes' spikes are equal within 1 ns."""

import pathlib
import sys

import h5py
import numpy


def trains(path):
    """Spike times in ns of each channel, in order."""
    with h5py.File(path) as file:
        spikes = file["spikes/out"]
        times, channels = spikes["timestamps_ns"][:], spikes["node_ids"][:]
        return [numpy.sort(times[channels == c]) for c in range(int(spikes.attrs["width"]))]


def main():
    folder = pathlib.Path(sys.argv[1])
    first, second = (trains(folder / f"{name}.h5") for name in sys.argv[2:4])
    counts = [len(train) for train in first]
    if counts != [len(train) for train in second] or min(counts) < 100:
        sys.exit(f"{counts} spikes, and {[len(train) for train in second]}")
    differences = [int(numpy.abs(a - b).max()) for a, b in zip(first, second)]
    print(f"{sum(counts)} spikes of {len(counts)} channels, at most {max(differences)} ns apart")
    sys.exit(max(differences) > 1)


if __name__ == "__main__":
    main()
