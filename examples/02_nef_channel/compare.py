"""Compares what was decoded with the ideal and draws both:  compare.py RUN_FOLDER PICTURE.png"""

import sys

from ideal import low_pass, rms
from spikeloop import style
from spikeloop.run_folder import RunFolder

BEGIN_S = 0.5  # before, the kernels fill

run = RunFolder(sys.argv[1])
signal = run.signal("signal")
times_s = signal.times_s
late = times_s > BEGIN_S

ideal = low_pass(times_s, signal.values)
decoded = run.signal("channel").at(times_s)
product_ideal = low_pass(times_s, ideal[:, :1] * ideal[:, 1:])
product = run.signal("product").at(times_s)

error = rms((decoded - ideal)[late])
product_error = rms((product - product_ideal)[late])
print(f"channel: rms error {error:.4f} of the radius")
print(f"product: rms error {product_error:.4f}")

with style.styled():
    figure = style.new_figure(9, 5)
    axes = figure.subplots(2, sharex=True)
    for channel, colour in enumerate([style.BLUE, style.VERMILLION]):
        axes[0].plot(times_s, decoded[:, channel], color=colour, label=f"x{channel}, decoded")
    axes[1].plot(times_s, product, color=style.GREEN, label="x0 x1, decoded")
    axes[0].plot(times_s, ideal, color=style.INK, lw=0.7, ls="--", label=["ideal", None])
    axes[1].plot(times_s, product_ideal, color=style.INK, lw=0.7, ls="--", label="ideal")
    for axis, title in zip(axes, [f"channel: rms error {error:.4f}",
                                  f"product: rms error {product_error:.4f}"]):
        axis.set_title(title, loc="left")
        axis.set_ylabel("value")
        axis.legend(loc="center left", bbox_to_anchor=(1, 0.5))
    axes[1].set_xlabel("time (s)")
    style.save(figure, sys.argv[2])
print(sys.argv[2])
