#!/usr/bin/python3
"""Decoding error of a NEF population, compared with an implementation in NumPy.

For populations of 25 to 3200 neurons and kernels of 5 to 200 ms, the held-out error of `spikeloop fit`
is compared with that of neurons which NumPy draws, simulates and decodes, without code of Spikeloop.
Prints a table and draws OUT/nef_decoding.png.

    benchmarks/decoding/nef_decoding.py [--out OUT] [--neurons 25,100,...] [--tau 0.005,...]
"""

import argparse
import pathlib
import re
import subprocess
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))

SPIKELOOP = ROOT / "build/release/bin/spikeloop"
DURATION_S = 60.0
TICK_S = 0.001
CUTOFF_HZ = 2.0
REGULARISATION = 0.01
TAU_M_S, T_REF_S = 0.02, 0.002
NEURONS = (25, 50, 100, 200, 400, 800, 1600, 3200)
TAUS_S = (0.005, 0.01, 0.03, 0.1, 0.2)


def ours(neurons, tau_s, seed):
    out = subprocess.run(
        [SPIKELOOP, "fit", "nef_encoder", "--neurons", str(neurons), "--tau", str(tau_s),
         "--seed", str(seed), "--duration", str(DURATION_S), "--cutoff", str(CUTOFF_HZ),
         "--regularisation", str(REGULARISATION)],
        check=True, capture_output=True, text=True).stdout
    return float(re.search(r"held-out error +([0-9.]+)", out)[1])


class Population:
    """Nengo's convention and its floor at 0, on a grid of 1 ms."""

    def __init__(self, neurons, rng):
        max_rate = rng.uniform(200, 400, neurons)
        intercept = rng.uniform(-1, 0.9, neurons)
        full = 1 / (1 - np.exp((T_REF_S - 1 / max_rate) / TAU_M_S))
        self.gain = (full - 1) / (1 - intercept) * rng.choice([-1, 1], neurons)
        self.bias = 1 - (full - 1) / (1 - intercept) * intercept
        self.potential = rng.uniform(0, 1, neurons)
        self.rests = np.zeros(neurons, int)  # ticks of the refractory period that are left

    def step(self, x):
        """Whether each neuron fires at the tick's end."""
        target = self.gain * x + self.bias
        free = self.rests == 0
        decayed = np.maximum(0, target + (self.potential - target) * np.exp(-TICK_S / TAU_M_S))
        self.potential = np.where(free, decayed, 0.0)
        self.rests = np.maximum(self.rests - 1, 0)
        fires = self.potential >= 1
        self.potential[fires] = 0
        self.rests[fires] = round(T_REF_S / TICK_S)
        return fires


def noise(rng, ticks):
    """32 sinusoids below the cutoff, of root-mean-square 1/2, cut to [-1, 1]."""
    time_s = np.arange(ticks) * TICK_S
    frequency = CUTOFF_HZ * rng.uniform(0, 1, (32, 1))
    phase = rng.uniform(0, 2 * np.pi, (32, 1))
    waves = np.sin(2 * np.pi * frequency * time_s + phase).sum(axis=0)
    return np.clip(0.5 * np.sqrt(2 / 32) * waves, -1, 1)


def numpys(neurons, taus_s, seed):
    """Held-out errors for all kernels of one simulation."""
    rng = np.random.default_rng(seed)
    population = Population(neurons, rng)
    ticks = round(DURATION_S / TICK_S)
    x = noise(rng, ticks)
    sums = {tau_s: np.zeros(neurons) for tau_s in taus_s}
    targets = dict.fromkeys(taus_s, 0.0)
    samples = {tau_s: ([], []) for tau_s in taus_s}
    for k in range(ticks):
        fires = population.step(x[k])
        for tau_s in taus_s:
            keep = np.exp(-TICK_S / tau_s)
            sums[tau_s] *= keep
            sums[tau_s][fires] += 1 / tau_s
            targets[tau_s] = x[k] + (targets[tau_s] - x[k]) * keep
            if k % 5 == 0 and k >= 5 * tau_s / TICK_S:
                samples[tau_s][0].append(sums[tau_s].copy())
                samples[tau_s][1].append(targets[tau_s])
    return {tau_s: _held_out(np.array(a), np.array(y), neurons)
            for tau_s, (a, y) in samples.items()}


def _held_out(a, y, neurons):
    split = round(0.75 * len(a))
    strength = REGULARISATION * a[:split].max()
    gram = a[:split].T @ a[:split] + split * strength**2 * np.eye(neurons)
    weights = np.linalg.solve(gram, a[:split].T @ y[:split])
    return float(np.sqrt(np.mean((a[split:] @ weights - y[split:]) ** 2)))


def seeds_of(neurons):
    return range(1, 1 + max(1, min(20, 1600 // neurons)))


def draw(rows, path):
    from spikeloop import style
    colours = [style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.INK]
    with style.styled():
        figure = style.new_figure(8.0, 5.2)
        axis = figure.subplots()
        for colour, tau_s in zip(colours, sorted({row[1] for row in rows})):
            chosen = [row for row in rows if row[1] == tau_s]
            sizes = [row[0] for row in chosen]
            axis.loglog(sizes, [row[2] for row in chosen], "o-", color=colour,
                        label=f"{tau_s * 1e3:g} ms")
            axis.loglog(sizes, [row[3] for row in chosen], "x", color=colour, ms=8)
        axis.set_xlabel("neurons")
        axis.set_ylabel("held-out root-mean-square error (range -1 to 1)")
        axis.set_xticks(sorted({row[0] for row in rows}),
                        [str(size) for size in sorted({row[0] for row in rows})])
        axis.minorticks_off()
        axis.legend(title="kernel (cross: NumPy)")
        style.save(figure, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/decoding"))
    parser.add_argument("--neurons", default=",".join(map(str, NEURONS)))
    parser.add_argument("--tau", default=",".join(map(str, TAUS_S)), help="seconds")
    arguments = parser.parse_args()
    sizes = [int(word) for word in arguments.neurons.split(",")]
    taus_s = [float(word) for word in arguments.tau.split(",")]
    arguments.out.mkdir(parents=True, exist_ok=True)
    print(f"{'neurons':>8} {'tau (ms)':>9} {'spikeloop fit':>14} {'NumPy':>9} {'ratio':>6}")
    rows = []
    for neurons in sizes:
        runs = [numpys(neurons, taus_s, seed) for seed in seeds_of(neurons)]
        for tau_s in taus_s:
            mine = np.mean([ours(neurons, tau_s, seed) for seed in seeds_of(neurons)])
            theirs = np.mean([run[tau_s] for run in runs])
            rows.append((neurons, tau_s, mine, theirs))
            print(f"{neurons:8d} {tau_s * 1e3:9g} {mine:14.5f} {theirs:9.5f} "
                  f"{mine / theirs:6.2f}", flush=True)
    draw(rows, arguments.out / "nef_decoding.png")
    print(f"picture: {arguments.out / 'nef_decoding.png'}")


if __name__ == "__main__":
    main()
