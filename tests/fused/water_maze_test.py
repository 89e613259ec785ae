#!/usr/bin/python3
"""Example 21: the prediction error that dopamine carries against the kernels of the critics' spikes; the swimmer
learns; the same seed gives the same bits."""

import pathlib
import tempfile

import numpy as np

import runs

TICK_S = 0.01
CRITICS = 40
TAU_S, RISE_S, DISCOUNT_S = 0.2, 0.05, 4.0


def latencies(folder):
    return [int(row["steps"]) for row in runs.recordings.table(folder / "episodes.csv")]


def held(folder, node, times_s):
    """A recorded signal at these times."""
    known_ns, values = runs.recordings.signal(folder, node)
    return values[np.searchsorted(known_ns * 1e-9, times_s + 1e-9, side="right") - 1]


def value_at(spikes_s, times_s):
    """V, a sum over the spikes of the last 5 s."""
    values = []
    for now in times_s:
        first, last = np.searchsorted(spikes_s, (now - 5, now), side="right")
        after = now - spikes_s[first:last]
        kernel = (np.exp(-after / TAU_S) - np.exp(-after / RISE_S)) / (TAU_S - RISE_S)
        values.append(0.02 / CRITICS * kernel.sum())
    return np.array(values)


def check_error(folder):
    """Over the first 20 s, and around the reward."""
    spikes_ns, channels = runs.recordings.spikes(folder, "brain")
    spikes_s = spikes_ns[channels < CRITICS] * 1e-9
    rewarded = np.flatnonzero(held(folder, "reward", np.arange(1, 60, TICK_S))[:, 0])
    assert len(rewarded), "no reward in the first minute"
    begin = 1 + rewarded[0] * TICK_S - 2
    ticks = np.round(np.concatenate([np.arange(1, 20, TICK_S), np.arange(begin, begin + 4, TICK_S)]) / TICK_S)
    before = (ticks - 1) * TICK_S  # the inputs come a tick later
    value = value_at(spikes_s, before)
    slope = (value_at(spikes_s, before + 1e-7) - value) / 1e-7
    reward = held(folder, "reward", before)[:, 0]
    steps = held(folder, "steps", before)[:, 0]
    where = held(folder, "where", before)
    distance = np.hypot(*where.T)
    at_wall = (distance > np.sqrt(0.97)) & (distance < 2)
    wanted = np.where(steps < 8, 0, 10 * reward - 0.05 - 0.5 * at_wall + slope - value / DISCOUNT_S)
    found = held(folder, "td_error", ticks * TICK_S)[:, 0]
    np.testing.assert_allclose(found, wanted, atol=1e-4)
    assert found.max() > 8 and at_wall.any() and (found < -0.2).any()


def main():
    with tempfile.TemporaryDirectory() as directory:
        folder = pathlib.Path(directory)
        experiment = folder / "water_maze.yaml"
        experiment.write_text(runs.spikeloop("new", "--environment", "water_maze")[0])

        def swim(name, seed, count):
            runs.run(experiment, folder / name, "--set", f"seed={seed}", "--set", f"episodes.count={count}")
            return latencies(folder / name)

        begin, end = [], []
        for seed in (101, 102, 104):
            steps = swim(f"seed{seed}", seed, 14)
            begin += steps[:4]
            end += steps[-6:]
        assert np.mean(end) < 0.6 * np.mean(begin), (begin, end)
        check_error(folder / "seed102")

        assert swim("once", 102, 3) == latencies(folder / "seed102")[:3]
        swim("again", 102, 3)
        assert runs.fingerprint(folder / "once") == runs.fingerprint(folder / "again")
        print(f"steps to the platform: {np.mean(begin):.0f} at first, {np.mean(end):.0f} later")


if __name__ == "__main__":
    main()
