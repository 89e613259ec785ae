"""Compares what regular and Poisson spikes of the same readings would drive:  speeds.py FOLDER PICTURE.png

Theory: a sum of Poisson spike trains of the rates r_i behind an exponential kernel, with weights w_i, has
the variance sum(w_i^2 r_i) / (2 tau) (Campbell's theorem).
"""

import json
import sys

import numpy as np
from spikeloop import style
from spikeloop.run_folder import RunFolder

TAU_S, RATE_MIN_HZ, RATE_MAX_HZ = 0.03, 1.0, 200.0

run = RunFolder(sys.argv[1])
weights = np.array(json.load(open("../01_braitenberg/readout_weights.json")))
times_s = np.arange(0.5, 10, 0.001)
readings = run.signal("scan").at(times_s)
rates_hz = RATE_MIN_HZ + (readings + 1) / 2 * (RATE_MAX_HZ - RATE_MIN_HZ)
expected = np.sqrt((rates_hz @ weights.T**2 / (2 * TAU_S)).mean(axis=0))
regular, noisy = (run.signal(label).at(times_s) for label in ("again_speed", "noisy_speed"))
found = np.sqrt(np.mean((noisy - regular) ** 2, axis=0))
for name, unit, a, b in zip(["speed", "turn"], ["m/s", "rad/s"], found, expected):
    print(f"{name}: Poisson spikes add {a:.3f} {unit} (root mean square), theory {b:.3f} {unit}")

with style.styled():
    figure = style.new_figure(9, 4.6)
    axes = figure.subplots(2, sharex=True)
    for row, (axis, label) in enumerate(zip(axes, ["speed (m/s)", "turn (rad/s)"])):
        axis.plot(times_s, noisy[:, row], color=style.VERMILLION, lw=0.6, label="Poisson spikes")
        axis.plot(times_s, regular[:, row], color=style.BLUE, lw=0.8, label="regular spikes")
        axis.set_ylabel(label)
    axes[0].legend(loc="upper right", ncols=2)
    axes[1].set_xlabel("time (s)")
    style.save(figure, sys.argv[2])
print(sys.argv[2])
