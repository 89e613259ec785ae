"""Draws the way of the tip to each target:  plot.py RUN_FOLDER PICTURE.png"""

import sys

import numpy as np
from spikeloop import style
from spikeloop.run_folder import RunFolder

run = RunFolder(sys.argv[1])
tip = run.signal("tip")
times_s, way = tip.times_s, 100 * tip.values  # cm
target = 100 * run.signal("target").at(times_s)
error = np.hypot(*(way - target).T)
ends = [np.mean(error[(times_s > end - 0.1) & (times_s <= end)]) for end in range(2, 18)]
print(f"distance from the target at the end of a second: {np.mean(ends):.2f} cm, at most {max(ends):.2f} cm")

with style.styled():
    figure = style.new_figure(5, 5)
    axes = figure.subplots()
    for begin in range(1, 17, 2):
        now = (times_s > begin) & (times_s <= begin + 1)
        axes.plot(*way[now].T, color=style.BLUE, label="tip" if begin == 1 else None)
        axes.plot(*target[now][-1], "o", ms=9, color=style.VERMILLION, label="target" if begin == 1 else None)
    axes.set_xlabel("x (cm)")
    axes.set_ylabel("y (cm)")
    axes.set_aspect("equal")
    axes.legend(loc="upper left", bbox_to_anchor=(0.6, 1.12), ncols=2)
    style.save(figure, sys.argv[2])
print(sys.argv[2])
