"""What the readouts' kernel makes of a signal without neurons."""

import numpy as np

TAU_S = 0.03


def low_pass(times_s, values):
    """exp(-t / TAU_S) / TAU_S over a signal whose row i holds from times_s[i] to times_s[i + 1]: its
    values at times_s (n x width), from 0."""
    result = np.zeros_like(values)
    keep = np.exp(-np.diff(times_s) / TAU_S)
    for i, k in enumerate(keep):
        result[i + 1] = k * result[i] + (1 - k) * values[i]
    return result


def rms(errors):
    return np.sqrt(np.mean(np.square(errors)))
