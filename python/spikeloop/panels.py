"""Signals drawn into one axes: lines with names and units, wide ones as an image."""

import numpy as np

from . import style

MOST_COLUMNS = 2000  # of an image: more than the picture has pixels
MOST_LINES = 4


def draw_image(figure, axes, signal, window, limits, bar_label):
    """Channels over time; `limits`: lower and upper edge of the vertical axis."""
    columns = np.linspace(*window, MOST_COLUMNS + 1)
    image = signal.at(0.5 * (columns[:-1] + columns[1:])).T
    shown = axes.imshow(image, aspect="auto", origin="lower", interpolation="nearest",
                        extent=(*window, *limits), cmap=style.value_map())
    bar = figure.colorbar(shown, ax=axes, pad=0.01, aspect=14, fraction=0.03)
    bar.set_label(bar_label)
    bar.outline.set_visible(False)


def steps(signal, channel, window):
    """Times and values of one channel as they are drawn: held to the end; empty without a value."""
    first = max(0, np.searchsorted(signal.times_s, window[0], side="right") - 1)
    last = np.searchsorted(signal.times_s, window[1], side="right")
    values = signal.values[first:last, channel]
    if not len(values):
        return np.empty(0), np.empty(0)
    times = np.append(signal.times_s[first:last], min(signal.until_s, window[1]))
    return times, np.append(values, values[-1])


def draw_zero(axes):
    axes.axhline(0.0, color=style.SOFT, linewidth=0.6, linestyle=(0, (4, 3)), zorder=0)
    axes.margins(y=0.12)


def draw_lines(axes, signal, window):
    """Up to MOST_LINES channels, told apart by colour and name."""
    for channel, colour in zip(range(signal.width), style.group_colours(signal.width)):
        name = signal.channels[channel] if signal.channels else f"channel {channel}"
        axes.step(*steps(signal, channel, window), where="post", color=colour, linewidth=1.1,
                  label=name)
    draw_zero(axes)
    if signal.width > 1:
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.98), ncol=signal.width,
                    borderaxespad=0.2, handlelength=1.4)


def unit_text(signal):
    """"value (m)"; numbers without a unit have none."""
    return "value" if signal.unit in ("", "1") else f"value ({signal.unit})"
