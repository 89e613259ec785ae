"""Draws where each cell fired, and compares its number of spikes with theory.

    place_fields.py RUN_FOLDER PICTURE.png

Theory: a cell's number of spikes is Poisson distributed, with the integral of its rate along the path as
mean: 40 Hz exp(-((x - x_c)^2 + (y - y_c)^2) / (2 sigma^2)). The path is the robot's own, not the messages.
"""

import json
import sys

import numpy as np
from spikeloop import style
from spikeloop.run_folder import RunFolder
from spikeloop.trajectory_plot import draw_world

RATE_MAX_HZ = 40.0

run = RunFolder(sys.argv[1])
grid = np.array(json.load(open("grid.json")))
(spikes,) = run.spikes("cells")
track = run.trajectory()
where = np.column_stack((track["x_m"], track["y_m"]))

apart = (where[:, None, :] - grid[:, :2]) / grid[:, 2:]  # samples x cells x (x, y)
rates_hz = RATE_MAX_HZ * np.exp(-(apart**2).sum(axis=2) / 2)
expected = np.trapz(rates_hz, track["t_s"], axis=0)
counted = np.bincount(spikes.channels, minlength=len(grid))
visited = expected > 10
scatter = (counted - expected)[visited] / np.sqrt(expected[visited])  # in standard deviations

print(f"{len(spikes.times_s)} spikes; expected {expected.sum():.0f}, give or take {expected.sum()**0.5:.0f}")
print(f"{visited.sum()} of {len(grid)} cells have 10 spikes or more to expect; their numbers deviate by")
print(f"{np.sqrt(np.mean(scatter**2)):.2f} standard deviations (root mean square; theory 1), "
      f"{np.abs(scatter).max():.1f} at most")

at = np.column_stack([np.interp(spikes.times_s, track["t_s"], line) for line in where.T])

with style.styled():
    figure = style.new_figure(12, 6.4)
    figure.get_layout_engine().set(w_pad=0.03, h_pad=0.03, wspace=0, hspace=0)
    left, right = figure.subfigures(1, 2, width_ratios=[1.2, 1])
    left.suptitle("Where each of the 25 cells fired")
    for place, axes in enumerate(left.subplots(5, 5).flat):
        cell = (4 - place // 5) * 5 + place % 5  # the first row of the grid is at the bottom
        draw_world(axes, run.world())
        axes.plot(*where.T, color=style.FILL, lw=0.6)
        axes.plot(*at[spikes.channels == cell].T, ".", color=style.VERMILLION, ms=3, mew=0)
        axes.plot(*grid[cell, :2], "+", color=style.INK, ms=5, mew=0.8)
        axes.set(aspect="equal", xlim=(-3.05, 3.05), ylim=(-3.05, 3.05))
        axes.axis("off")
    axes = right.subplots()
    most = expected.max() * 1.1
    axes.plot([0, most], [0, most], color=style.SOFT, lw=1)
    axes.errorbar(expected, counted, yerr=np.sqrt(expected), fmt="o", color=style.VERMILLION, ms=5,
                  ecolor=style.SOFT, elinewidth=0.8)
    axes.set(xlabel="integral of the rate along the path", ylabel="spikes of a cell",
             title="Counted and expected (bars: 1 standard deviation)")
    style.save(figure, sys.argv[2])
print(sys.argv[2])
