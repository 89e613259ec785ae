"""Signals drawn into panels above one time axis: few channels as lines, more as an image."""

import numpy as np

from . import quantities, style

MOST_COLUMNS = 2000  # of an image: more than the picture has pixels
MOST_LINES = 4
LINES_IN, IMAGE_IN = 1.3, 2.0  # heights


def of_signal(signal, title, window):
    """Pairs of a height (inches) and a function that draws into (figure, axes): a panel a quantity."""
    groups = {}
    for channel, quantity in enumerate(signal.quantities or [_quantity(signal)] * signal.width):
        groups.setdefault(quantity, []).append(channel)
    return [(LINES_IN if len(channels) <= MOST_LINES else IMAGE_IN,
             lambda figure, axes, title="" if number else title, quantity=quantity, channels=channels:
             _draw(figure, axes, signal, channels, quantity, title, window))
            for number, (quantity, channels) in enumerate(groups.items())]


def draw_column(panels, path, window):
    """Writes a picture of panels one below the other, over the time in `window` (s)."""
    with style.styled():
        figure = style.new_figure(10.0, 0.9 + sum(height for height, _ in panels))
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False,
                               gridspec_kw={"height_ratios": [height for height, _ in panels]})[:, 0]
        for panel, (_, draw) in zip(axes, panels):
            draw(figure, panel)
        axes[0].set_xlim(*window)
        axes[-1].set_xlabel("time (s)")
        figure.align_ylabels(axes)
        style.save(figure, path)


def _quantity(signal):
    if signal.unit == quantities.POTENTIAL[1]:
        return quantities.POTENTIAL
    return quantities.UNKNOWN[0], "" if signal.unit == "1" else signal.unit


def _draw(figure, axes, signal, channels, quantity, title, window):
    axes.set_title(title, loc="left")
    if len(channels) > MOST_LINES:
        _draw_image(figure, axes, signal, channels, _axis_text(*quantity), window)
        return
    names = [signal.channels[channel] if signal.channels else f"channel {channel}" for channel in channels]
    lone = len(channels) == 1
    for channel, name, colour in zip(channels, names, style.group_colours(len(channels))):
        axes.step(*steps(signal, channel, window), where="post", color=style.INK if lone else colour,
                  linewidth=1.1, label=name)
    _show_zero(axes)
    named = lone and bool(signal.channels)
    axes.set_ylabel(_axis_text(names[0] if named else quantity[0], quantity[1]))
    if not lone:
        style.legend_beside(axes)


def _axis_text(name, unit):
    """In two lines."""
    gap = " " if "\n" in name else "\n"
    return f"{name}{gap}({unit})" if unit else name


def steps(signal, channel, window):
    """Times and values of one channel as they are drawn: held to the end; empty without a value."""
    first = max(0, np.searchsorted(signal.times_s, window[0], side="right") - 1)
    last = np.searchsorted(signal.times_s, window[1], side="right")
    values = signal.values[first:last, channel]
    if not len(values):
        return np.empty(0), np.empty(0)
    times = np.append(signal.times_s[first:last], min(signal.until_s, window[1]))
    return times, np.append(values, values[-1])


def _show_zero(axes):
    """Where it is not far from the values, as it is from a membrane potential."""
    axes.margins(y=0.12)
    low, high = axes.dataLim.intervaly
    if high - low > 0.5 * max(abs(low), abs(high)):
        axes.axhline(0.0, color=style.SOFT, linewidth=0.6, linestyle=(0, (4, 3)), zorder=0)


def _draw_image(figure, axes, signal, channels, bar_label, window):
    columns = np.linspace(*window, MOST_COLUMNS + 1)
    image = signal.at(0.5 * (columns[:-1] + columns[1:])).T[channels]
    low, high = -0.5, len(channels) - 0.5
    if signal.beams:
        first, step = signal.beams
        low, high = (first + edge * step for edge in (low, high))
        axes.set_ylabel("beam angle (°)" + ("\nright ←  → left" if low < 0 < high else ""))
        axes.set_yticks(_angle_ticks(low, high))
    else:
        axes.set_ylabel("channel (index)")
        axes.yaxis.get_major_locator().set_params(integer=True)
    shown = axes.imshow(image, aspect="auto", origin="lower", interpolation="nearest",
                        extent=(*window, low, high), cmap=style.value_map())
    bar = figure.colorbar(shown, cax=axes.inset_axes([1.01, 0.0, 0.015, 1.0]))  # in the margin of legends
    bar.set_label(bar_label)
    bar.outline.set_visible(False)


def _angle_ticks(low, high):
    step = 45 if high - low <= 200 else 90
    return np.arange(np.ceil(low / step - 0.02) * step, high + 0.02 * step, step)
