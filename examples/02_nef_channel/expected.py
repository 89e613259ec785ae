"""What error to expect of a channel: NumPy draws neurons, simulates and decodes them by itself.

    expected.py RUN_FOLDER NEURONS        the run gives the signal
"""

import sys

import numpy as np
from ideal import TAU_S, low_pass, rms
from spikeloop.run_folder import RunFolder

TICK_S, TAU_M_S, T_REF_S = 0.001, 0.02, 0.002
POPULATIONS = 6
EVERY = 5  # ticks between two samples


def noise(rng, ticks):
    """Two channels of 32 sinusoids below 2 Hz; vectors longer than 1 are cut."""
    waves = [np.sin(2 * np.pi * rng.uniform(0, 2, (32, 1)) * np.arange(ticks) * TICK_S
                    + rng.uniform(0, 2 * np.pi, (32, 1))).sum(axis=0) / 8 for _ in range(2)]
    x = np.array(waves).T
    return x / np.maximum(1, np.linalg.norm(x, axis=1, keepdims=True))


def filtered_spikes(rng, x, neurons):
    """Leaky integrate-and-fire neurons: rates at the radius from 200 to 400 Hz, intercepts from -1 to
    0.9. Their spikes behind the kernel, populations x samples x neurons."""
    size = POPULATIONS * neurons
    angle, intercept = rng.uniform(0, 2 * np.pi, size), rng.uniform(-1, 0.9, size)
    full = 1 / (1 - np.exp((T_REF_S - 1 / rng.uniform(200, 400, size)) / TAU_M_S))
    gain = (full - 1) / (1 - intercept)
    encoders, bias = gain * np.array([np.cos(angle), np.sin(angle)]), 1 - gain * intercept
    potential, rests = rng.uniform(0, 1, size), np.zeros(size)
    keep, keep_trace = np.exp(-TICK_S / TAU_M_S), np.exp(-TICK_S / TAU_S)
    activity = np.zeros((POPULATIONS, len(x) // EVERY, neurons))
    trace = np.zeros(size)
    for k, vector in enumerate(x):
        target = vector @ encoders + bias
        potential = np.maximum(0, target + (potential - target) * keep)
        potential[rests > 0] = 0
        rests -= 1
        fires = np.flatnonzero(potential >= 1)
        potential[fires], rests[fires] = 0, round(T_REF_S / TICK_S)
        trace *= keep_trace
        trace[fires] += 1 / TAU_S
        if k % EVERY == 0:
            activity[:, k // EVERY] = trace.reshape(POPULATIONS, neurons)
    return activity


signal, neurons = RunFolder(sys.argv[1]).signal("signal").values, int(sys.argv[2])
rng = np.random.default_rng(1)
training = noise(rng, 40_000)
x = np.concatenate([training, signal])
target = low_pass(np.arange(len(x)) * TICK_S, x)[::EVERY]
fit = slice(200 // EVERY, len(training) // EVERY)  # before, the kernel fills
test = slice((len(training) + 500) // EVERY, None)
errors = []
for a in filtered_spikes(rng, x, neurons):
    ridge = len(a[fit]) * (0.01 * a[fit].max()) ** 2 * np.eye(neurons)
    weights = np.linalg.solve(a[fit].T @ a[fit] + ridge, a[fit].T @ target[fit])
    errors.append(rms(a[test] @ weights - target[test]))
print(f"{neurons} neurons: rms error {np.mean(errors):.4f}, from {min(errors):.4f} to "
      f"{max(errors):.4f} in {POPULATIONS} populations")
