"""Draws the signal above the spikes of both encoders:  raster.py FOLDER PICTURE.png"""

import sys

from spikeloop import style
from spikeloop.run_folder import RunFolder

run = RunFolder(sys.argv[1])
signal = run.signal("sine")
with style.styled():
    figure = style.new_figure(9, 5.5)
    axes = figure.subplots(3, sharex=True)
    axes[0].plot(signal.times_s, signal.values, color=style.SOFT, lw=0.5)
    axes[0].plot(signal.times_s, signal.values[:, 0], color=style.INK)
    axes[0].set(title="Ten sine waves, channel 0 in black", ylabel="value")
    for axis, (label, colour, title) in zip(axes[1:], [
            ("encoder", style.VERMILLION, "Spikes of encoder.py"),
            ("built_in", style.BLUE, "Spikes of rate_encoder")]):
        (spikes,) = run.spikes(label)
        axis.plot(spikes.times_s, spikes.channels, "|", color=colour, ms=7, mew=0.7)
        axis.set(title=title, ylabel="channel", yticks=[0, 5, 9])
    axes[2].set_xlabel("time (s)")
    style.save(figure, sys.argv[2])
print(sys.argv[2])
