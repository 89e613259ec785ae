"""Target, decoded signal and error of `spikeloop fit`, which sends them to standard input as JSON.

python3 -m spikeloop.fit_plot PICTURE.png < fit.json
"""

import json
import sys

import numpy as np

from . import style

MOST_OUTPUTS = 4


def draw(data, path):
    """Writes the picture. Held-out moments as curves over time, static inputs as dots."""
    target, decoded = np.array(data["target"]), np.array(data["decoded"])
    outputs = min(len(target), MOST_OUTPUTS)
    over_time = bool(data["time_s"])
    with style.styled():
        figure = style.new_figure(9.0, 1.0 + 2.6 * outputs)
        axes = figure.subplots(outputs, 2, squeeze=False, gridspec_kw={"width_ratios": [3, 1]})
        for k in range(outputs):
            if over_time:
                _curves(axes[k, 0], np.array(data["time_s"]), target[k], decoded[k])
            else:
                _dots(axes[k, 0], np.array(data["input"]), target[k], decoded[k])
            _errors(axes[k, 1], decoded[k] - target[k])
            axes[k, 0].set_ylabel(f"output {k}")
        axes[0, 0].legend(loc="upper right", ncols=2)
        axes[-1, 0].set_xlabel("time (s)" if over_time else "first input")
        axes[-1, 1].set_xlabel("error")
        axes[0, 0].set_title(f"{data['title']}: held-out error {data['held_out_error']:.4f}, "
                             f"training {data['training_error']:.4f}", loc="left")
        style.save(figure, path)


def _curves(axis, time_s, target, decoded):
    axis.plot(time_s, target, color=style.INK, lw=1.4, label="target")
    axis.plot(time_s, decoded, color=style.VERMILLION, lw=0.9, label="decoded")
    axis.set_xlim(time_s[0], time_s[-1])


def _dots(axis, inputs, target, decoded):
    axis.plot(inputs, target, ".", ms=3, color=style.INK, label="target")
    axis.plot(inputs, decoded, ".", ms=2, color=style.VERMILLION, label="decoded")


def _errors(axis, errors):
    axis.hist(errors, bins=41, color=style.BLUE)
    axis.axvline(0, color=style.INK, lw=0.8)
    axis.set_yticks([])


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    try:
        draw(json.load(sys.stdin), sys.argv[1])
    except OSError as error:
        sys.exit(f"cannot write {sys.argv[1]}: {error.strerror}")


if __name__ == "__main__":
    main()
