"""Counts the spikes that went into a model and came out of it, and draws them:  rates.py RUN PICTURE"""
import sys

import numpy as np
from spikeloop import style
from spikeloop.run_folder import RunFolder

run = RunFolder(sys.argv[1])
parts = [("encoder", style.BLUE, "Spikes into the model"),
         ("brain", style.VERMILLION, "Spikes out of it")]
trains = [run.spikes(label)[0] for label, _, _ in parts]
counts = [np.bincount(train.channels.astype(int), minlength=10) for train in trains]
for channel, (sent, answered) in enumerate(zip(*counts)):
    print(f"channel {channel}: {sent:4} in, {answered:4} out")
with style.styled():
    figure = style.new_figure(9, 4)
    axes = figure.subplots(2, sharex=True)
    for axis, train, (_, colour, title) in zip(axes, trains, parts):
        axis.plot(train.times_s, train.channels, "|", color=colour, ms=7, mew=0.7)
        axis.set(title=title, ylabel="channel", yticks=[0, 5, 9])
    axes[1].set_xlabel("time (s)")
    style.save(figure, sys.argv[2])
