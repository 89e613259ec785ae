"""The interface in Python, cell by cell: run it as a script, or open it in Jupyter (jupytext) or an editor."""

# %% An experiment is a file. Keys can be read, with their defaults, and set.
import json
import pathlib

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

import spikeloop  # noqa: E402

FILE = pathlib.Path("../01_braitenberg/braitenberg.yaml")
experiment = spikeloop.load(FILE, {"sync": "lockstep", "duration": "10 s"})
print("rate_max", experiment["encoder.rate_max"], "Hz; tau", experiment["decoder.tau"], "s")

# %% Ten seeds: what the wheels get.
runs = [experiment.run(seed=seed) for seed in range(1, 11)]
times_s = np.arange(0.5, 10, 0.1)
speeds = np.array([run["wheels"].signal.at(times_s)[:, 0] for run in runs])
lower, mean, upper = np.percentile(speeds, 25, axis=0), speeds.mean(axis=0), np.percentile(speeds, 75, axis=0)
figure, axes = plt.subplots(figsize=(6, 3), dpi=120)
axes.fill_between(times_s, lower, upper, alpha=0.25, label="quartiles")
axes.plot(times_s, mean, label="mean of 10 seeds")
axes.set(xlabel="time (s)", ylabel="speed command (m/s)", ylim=(0, None))
axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2, frameon=False)
axes.spines[["top", "right"]].set_visible(False)
figure.tight_layout()
figure.savefig("seeds.png")
print("seeds.png;", sum(run.summary()["collisions"] for run in runs), "collisions in 10 runs")

# %% Other weights: a tenth of the turning rate.
weights = np.array(json.loads((FILE.parent / "readout_weights.json").read_text()))
weights[1] *= 0.1
slow = [experiment.run(seed=seed, set={"decoder.weights": weights}) for seed in range(1, 11)]
print("collisions with a tenth of the turning rate:", sum(run.summary()["collisions"] for run in slow))

# %% Step by step, until something is near.
with experiment.open() as loop:
    while loop.step(10):
        scan = loop.signal("scan.out")  # -1: near, 1: far
        if scan is not None and scan.min() < -0.8:
            break
    turn = loop.signal("wheels.command")[1]
    print(f"at {loop.time_s:.2f} s a beam is at {scan.min():.2f}; the vehicle turns by {turn:.2f} rad/s")

# %% Spikes for Neo and Elephant.
block = runs[0].neo_block()
trains = [train for train in block.segments[0].spiketrains if train.name.startswith("encoder")]
print(len(trains), "spike trains,", sum(map(len, trains)), "spikes")
