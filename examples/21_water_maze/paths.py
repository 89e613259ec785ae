"""Draws the way of the swimmer in the first and the last trials:  paths.py RUN_FOLDER PICTURE.png"""

import sys

import numpy as np
from spikeloop import open_run, style

COUNT = 4
run = open_run(sys.argv[1])
where = run.signal("where")
trials = run.episodes()
inside = np.abs(where.values).max(axis=1) <= 1  # not in a pause

with style.styled():
    figure = style.new_figure(7.0, 4.0)
    for axes, trial in zip(figure.subplots(2, COUNT).flat, [*range(COUNT), *range(-COUNT, 0)]):
        now = inside & (where.times_s >= trials["begin_s"][trial]) & (where.times_s <= trials["end_s"][trial])
        for centre, radius, colour in (((0, 0), 1, style.INK), ((0.35, 0.35), 0.1, style.VERMILLION)):
            angle = np.linspace(0, 2 * np.pi, 100)
            axes.plot(centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle), color=colour)
        axes.plot(*where.values[now].T, color=style.BLUE)
        axes.set_title(f"trial {trials['episode'][trial]:.0f}: {0.1 * trials['steps'][trial]:.1f} s")
        axes.set_aspect("equal")
        axes.set_axis_off()
    style.save(figure, sys.argv[2])
print(sys.argv[2])
