"""Draws how long the swimmer needs, trial by trial, and how often it finds the platform:
latency.py SWEEP_FOLDER PICTURE.png"""

import pathlib
import sys

import numpy as np
from matplotlib.ticker import MaxNLocator
from spikeloop import open_run, style

STEP_S = 0.1
tables = [open_run(path.parent).episodes() for path in sorted(pathlib.Path(sys.argv[1]).glob("*/episodes.csv"))]
latency_s = STEP_S * np.array([table["steps"] for table in tables])
success = 100 * np.mean([table["success"] for table in tables], axis=0)
trial = np.arange(1, latency_s.shape[1] + 1)
low, median, high = np.percentile(latency_s, (25, 50, 75), axis=0)
for name, part in (("first", slice(0, 4)), ("last", slice(-4, None))):
    print(f"{name} 4 trials: {np.median(latency_s[:, part]):.1f} s, {success[part].mean():.0f} % successful")

with style.styled():
    figure = style.new_figure(7.0, 5.2)
    times, rate = figure.subplots(2, 1, sharex=True)
    times.fill_between(trial, low, high, color=style.BLUE, alpha=0.2, linewidth=0)
    times.plot(trial, median, color=style.BLUE)
    times.set_title(f"Median and quartiles of {len(tables)} runs", loc="left")
    times.set_ylabel("latency (s)")
    times.set_ylim(0, 51)
    rate.plot(trial, success, color=style.BLUE, clip_on=False)
    rate.set_ylabel("success (%)")
    rate.set_ylim(0, 103)
    rate.set_xlabel("trial")
    rate.xaxis.set_major_locator(MaxNLocator(integer=True))
    figure.align_ylabels([times, rate])
    style.save(figure, sys.argv[2])
print(sys.argv[2])
