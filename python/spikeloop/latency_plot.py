"""latency: from a sensor's message to the first command computed from it, over time and how often."""

import numpy as np

from . import style
from .run_folder import RunFolderError

OUTLIERS = 3.0  # times the 99th percentile: more would hide all that lies below


def draw(parts, path, window):
    """Writes the picture, a row a command; returns a list of sentences about what is missing.

    Raises RunFolderError when no latency is recorded.
    """
    streams = [stream for stream in map(lambda signal: within(signal, window), parts.latencies)
               if len(stream[1])]
    if not streams:
        raise RunFolderError("no latency is recorded: it takes a sensor's message that reaches a "
                             "command over a topic")
    with style.styled():
        figure = style.new_figure(10.0, 0.6 + 3.0 * len(streams))
        axes = figure.subplots(len(streams), 2, squeeze=False, sharey="row",
                               gridspec_kw={"width_ratios": [3, 1]})
        for row, (times_s, latencies_ms, label) in zip(axes, streams):
            _draw_row(row, times_s, latencies_ms, label)
            row[0].set_xlim(*window)
        axes[-1, 0].set_xlabel("time (s)")
        axes[-1, 1].set_xlabel("messages")
        style.save(figure, path)
    return []


def within(signal, window):
    """Times (s) and latencies (ms) inside the window, and whose they are."""
    inside = (signal.times_s >= window[0]) & (signal.times_s <= window[1])
    return signal.times_s[inside], signal.values[inside, 0], signal.label


def statistics(latencies_ms):
    """Median and 99th percentile, by nearest rank as in summary.json."""
    ordered = np.sort(latencies_ms)
    return tuple(ordered[max(1, int(np.ceil(part * len(ordered)))) - 1] for part in (0.5, 0.99))


def _draw_row(row, times_s, latencies_ms, label):
    median, p99 = statistics(latencies_ms)
    top = upper_limit(latencies_ms, p99)
    beyond = latencies_ms > top
    row[0].plot(times_s[~beyond], latencies_ms[~beyond], ".", markersize=4, color=style.BLUE,
                rasterized=True)
    if beyond.any():
        row[0].plot(times_s[beyond], np.full(beyond.sum(), top), "^", markersize=7, clip_on=False,
                    color=style.VERMILLION)
        row[0].set_title(f"▲ {beyond.sum()} above, up to {latencies_ms.max():.3g} ms", loc="right",
                         color=style.VERMILLION, fontsize=10)
    row[1].hist(latencies_ms[~beyond], bins=np.linspace(0, top, 81), orientation="horizontal",
                color=style.BLUE)
    for axes in row:
        axes.axhline(median, color=style.SOFT, linewidth=0.8, zorder=0)
        axes.axhline(p99, color=style.SOFT, linewidth=0.8, linestyle=(0, (4, 3)), zorder=0)
    close = p99 - median < 0.1 * top
    for value, text, at in ((median, f"median {median:.3g} ms", "top" if close else "bottom"),
                            (p99, f"p99 {p99:.3g} ms", "bottom")):
        note = row[1].annotate(text, (1.0, value), xycoords=("axes fraction", "data"), ha="right",
                               va=at, xytext=(0, 2 if at == "bottom" else -3), fontsize=10,
                               textcoords="offset points")
        note.set_in_layout(False)
    row[0].set_ylim(0, top)
    row[0].set_ylabel("latency (ms)")
    row[0].set_title(f"Sensor to command ({label}): {len(latencies_ms):,} messages", loc="left")


def upper_limit(latencies_ms, p99):
    """Of the axis: above all values, unless a few of them are far above the others."""
    largest = latencies_ms.max()
    return float(1.15 * (largest if largest <= OUTLIERS * p99 else 1.3 * p99)) or 1.0
