#!/usr/bin/python3
"""The same regression as `spikeloop fit`, with NumPy and h5py alone.

check_fit.py RUN.h5 WEIGHTS.npy: fails unless the weights are those that NumPy finds; prints its own
held-out error.
"""

import sys

import h5py
import numpy as np

TAU_S = 0.05
REGULARISATION = 0.02
TICK_S = 0.001
NEURONS = 40


def main():
    with h5py.File(sys.argv[1]) as file:
        stamps_s = file["spikes/out/timestamps_ns"][:] * 1e-9
        neurons = file["spikes/out/node_ids"][:].astype(int)
        row_s = file["signals/in/times_ns"][:] * 1e-9
        rows = file["signals/in/values"][:]
    begin_s = row_s[0]
    stamps_s, neurons = stamps_s[stamps_s > begin_s], neurons[stamps_s > begin_s]
    ticks = round((8 - begin_s) / TICK_S)
    ends_s = begin_s + np.arange(1, ticks + 1) * TICK_S
    held = rows[np.searchsorted(row_s, ends_s - TICK_S + 1e-9, side="right") - 1]
    wanted = np.stack([held[:, 0] * held[:, 1], held[:, 0]], axis=1)
    keep = np.exp(-TICK_S / TAU_S)
    targets = np.zeros_like(wanted)
    for k, row in enumerate(wanted):
        before = targets[k - 1] if k else 0
        targets[k] = row + (before - row) * keep
    chosen = np.arange(250, ticks, 5)  # from 5 tau on, every fifth tick
    activities = np.zeros((len(chosen), NEURONS))
    for i, k in enumerate(chosen):  # the kernel's sum as it stands in the paper
        age_s = ends_s[k] - stamps_s
        past = age_s >= -1e-12
        kernel = np.exp(-age_s[past] / TAU_S) / TAU_S
        activities[i] = np.bincount(neurons[past], kernel, NEURONS)
    settled_s = begin_s + 5 * TAU_S
    training = ends_s[chosen] < settled_s + 0.75 * (8.0 - settled_s) - 1e-9
    a, y = activities[training], targets[chosen][training]
    strength = REGULARISATION * a.max()
    # The regularisation as more rows, solved by singular values: no normal equations.
    more = strength * np.sqrt(len(a)) * np.eye(NEURONS)
    weights = np.linalg.lstsq(np.vstack([a, more]),
                              np.vstack([y, np.zeros((NEURONS, y.shape[1]))]), rcond=None)[0].T
    errors = activities[~training] @ weights.T - targets[chosen][~training]
    print(f"held-out error   {np.sqrt(np.mean(errors**2)):.6f}")
    found = np.load(sys.argv[2])
    worst = np.abs(found - weights).max() / np.abs(weights).max()
    print(f"largest difference of a weight: {worst:.2e} of the largest")
    sys.exit(int(found.shape != weights.shape or worst > 1e-6))


if __name__ == "__main__":
    main()
