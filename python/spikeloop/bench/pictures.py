"""A picture a part, drawn from results.json."""

import numpy as np

from .. import style
from . import chain, figures, paper, simulators, sweeps
from .results import ResultsError

LAYOUT_COLOURS = {"fused": style.BLUE, "separate": style.VERMILLION}
MARKERS = {"none": "o", "builtin": "s", "nest": "^", "neuron": "D", "brian2": "v"}
LEAST_FACTOR = 0.01  # below, nobody looks


def draw(document, folder):
    """Draws every part that has something; gives the paths. Raises ResultsError."""
    drawn = []
    for name, paint in (("a", _part_a), ("b", _part_b), ("c", _part_c), ("d", _part_d)):
        with style.styled():
            figure = paint(document)
            if figure is not None:
                path = folder / f"{name}.png"
                _save(figure, path)
                drawn.append(path)
    return drawn


def _save(figure, path):
    try:
        style.save(figure, path)
    except OSError as error:  # of a full disk: without the file's name; Pillow's own: without strerror
        raise ResultsError(f"cannot write '{path}': {error.strerror or error}") from None


def _part_a(document):
    tick_ms = sweeps.COARSE_TICK_MS
    layouts = [layout for layout in figures.layouts(document)
               if any(figures.curve(document, layout, encoder, simulator, tick_ms)
                      for encoder in chain.ENCODERS for simulator in simulators.NAMES)]
    if not layouts:
        return None
    figure, all_axes, below = _figure(12.0, 3.6, len(layouts), len(chain.ENCODERS), 2)
    for row, layout in zip(all_axes, layouts):
        for axes, encoder in zip(row, chain.ENCODERS):
            _curves(document, axes, layout, encoder, tick_ms)
            axes.set_title(f"{encoder}, {layout}", loc="left")
        row[0].set_ylabel("real-time factor")
    for axes in all_axes[-1]:
        axes.set_xlabel("encoding neurons")
    _legend(below, all_axes)
    return figure


def _curves(document, axes, layout, encoder, tick_ms):
    for colour, simulator in zip(style.group_colours(len(MARKERS)), MARKERS):
        points = figures.curve(document, layout, encoder, simulator, tick_ms)
        if points:
            _factors(axes, [point["neurons"] for point in points], points, colour,
                     MARKERS[simulator], simulators.NAMES[simulator])
    alone = figures.curve(document, "alone", "rate", "nest", tick_ms)
    if alone and encoder == "rate":
        _factors(axes, [point["neurons"] for point in alone], alone, style.GREEN, "x",
                 "NEST alone", dashed=True)
    _real_time(axes)
    _mark(axes, paper.NEURONS[encoder], figures.goal(layout, encoder))
    axes.set_xscale("log")


def _factors(axes, xs, points, colour, marker, label, dashed=False):
    medians = np.array([point["real_time_factor"] for point in points])
    low, high = np.array([figures.spread(point) for point in points]).T
    axes.errorbar(xs, medians, yerr=[medians - low, high - medians], color=colour, marker=marker,
                  markersize=4.5, linewidth=1.1, capsize=2, label=label,
                  linestyle="--" if dashed else "-")
    bounds = [i for i, point in enumerate(points) if figures.is_bound(point)]
    if bounds:
        axes.plot(np.array(xs)[bounds], medians[bounds], linestyle="", marker=marker, markersize=4.5,
                  markeredgecolor=colour, markerfacecolor="white", zorder=3)
        axes.plot([], [], linestyle="", marker="o", markersize=4.5, markeredgecolor=style.INK,
                  markerfacecolor="white", label="at most: was stopped")
    axes.set_yscale("log")


def _real_time(axes):
    axes.axhline(1.0, color=style.INK, linewidth=0.8, zorder=0)


def _mark(axes, of_paper, of_goal):
    if of_paper is not None:
        axes.axvline(of_paper, color=style.SOFT, linewidth=1.0, linestyle=(0, (4, 3)), zorder=0,
                     label="paper: largest in real time")
    if of_goal is not None:
        axes.axvline(of_goal, color=style.SOFT, linewidth=1.0, linestyle=(0, (1, 2)), zorder=0,
                     label="goal, no simulator")


def _figure(width_in, height_in, rows=1, columns=1, legend_rows=1):
    """A figure, its axes, and those below for its legend."""
    legend_in = 0.28 * legend_rows
    figure = style.new_figure(width_in, height_in * rows + legend_in)
    grid = figure.add_gridspec(rows + 1, columns, height_ratios=[height_in] * rows + [legend_in])
    below = figure.add_subplot(grid[rows, :])
    below.axis("off")
    first = None
    all_axes = np.empty((rows, columns), dtype=object)
    for row, column in np.ndindex(rows, columns):
        all_axes[row, column] = figure.add_subplot(grid[row, column], sharex=first, sharey=first)
        first = first or all_axes[row, column]
        all_axes[row, column].tick_params(labelleft=column == 0)
    return figure, all_axes, below


def _legend(below, all_axes, columns=4):
    found = {}
    for axes in np.ravel(all_axes):
        for handle, label in zip(*axes.get_legend_handles_labels()):
            found.setdefault(label, handle)
    below.legend(found.values(), found.keys(), loc="center", ncols=columns)


def _part_b(document):
    layouts = [layout for layout in figures.layouts(document) if figures.by_rate(document, layout)]
    if not layouts:
        return None
    figure, [[axes]], below = _figure(8.0, 4.4, legend_rows=2)
    for layout in layouts:
        points = figures.by_rate(document, layout)
        _factors(axes, [point["rate_max_hz"] for point in points], points,
                 LAYOUT_COLOURS[layout], "o", layout)
        goal = figures.goal(layout, "rate_hz")
        if points[0]["neurons"] == paper.RATE_NEURONS:
            axes.axvline(goal, color=LAYOUT_COLOURS[layout], linewidth=1.0, linestyle=(0, (1, 2)),
                         zorder=0, label=f"goal, {layout}")
    same = points[0]["neurons"] == paper.RATE_NEURONS
    _mark(axes, paper.RATE_HZ if same else None, None)
    _real_time(axes)
    axes.set_xscale("log")
    axes.set_xlabel("firing rate of each neuron (spikes/s)")
    axes.set_ylabel("real-time factor")
    axes.set_title(f"{points[0]['neurons']:,} neurons, tick {sweeps.COARSE_TICK_MS} ms", loc="left")
    _legend(below, axes, 3)
    return figure


def _part_c(document):
    if not document["latencies"]:
        return None
    figure, [[axes]], below = _figure(8.0, 4.4, legend_rows=2)
    for layout, colour in LAYOUT_COLOURS.items():
        rows = sorted((row for row in document["latencies"] if row["layout"] == layout),
                      key=lambda row: row["tick_ms"])
        if rows:
            ticks = [row["tick_ms"] for row in rows]
            axes.plot(ticks, [row["median_ms"] for row in rows], color=colour, marker="o",
                      markersize=4.5, label=f"{layout}: median")
            axes.fill_between(ticks, [row["min_ms"] for row in rows],
                              [row["p99_ms"] for row in rows], color=colour, alpha=0.15,
                              linewidth=0, label=f"{layout}: least to 99 %")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("tick (ms)")
    axes.set_ylabel("scan to command (ms)")
    axes.set_title("One channel, over ROS 1", loc="left")
    _legend(below, axes)
    return figure


def _part_d(document):
    ticks = sorted({point["tick_ms"] for point in figures.points(document)
                    if point["simulator"] == "none" and point["encoder"] == "rate"})
    layouts = figures.layouts(document)
    if len(ticks) < 2:
        return None
    figure, all_axes, below = _figure(11.0, 4.4, 1, len(layouts))
    all_axes = all_axes[0]
    for axes, layout in zip(all_axes, layouts):
        _map(document, axes, layout, ticks)
        axes.set_title(f"rate, {layout}", loc="left")
        axes.set_xlabel("tick (ms)")
    all_axes[0].set_ylabel("encoding neurons")
    bar = figure.colorbar(all_axes[0].collections[0], ax=list(all_axes), pad=0.01, aspect=25)
    bar.set_label("real-time factor")
    bar.outline.set_visible(False)
    _legend(below, all_axes)
    return figure


def _map(document, axes, layout, ticks):
    from matplotlib.colors import LogNorm
    found = [point for tick_ms in ticks
             for point in figures.curve(document, layout, "rate", "none", tick_ms)]
    axes.scatter([point["tick_ms"] for point in found], [point["neurons"] for point in found],
                 c=[max(LEAST_FACTOR, point["real_time_factor"]) for point in found],
                 norm=LogNorm(0.1, 100), cmap=style.value_map(), s=42, zorder=2)
    best = [entry for tick_ms in ticks
            if (entry := figures.largest(document, layout, "rate", "none", tick_ms))]
    axes.plot([entry["tick_ms"] for entry in best], [entry["neurons"] for entry in best],
              color=style.VERMILLION, linewidth=1.4, zorder=3, label="largest in real time")
    axes.plot([paper.FINE_TICK_MS], [paper.FINE_TICK_NEURONS], linestyle="", marker="*",
              markersize=13, color=style.INK, zorder=4, label="paper: largest at 1 ms")
    axes.plot([paper.FINE_TICK_MS], [figures.goal(layout, "fine_tick")], linestyle="", marker="_",
              markersize=16, markeredgewidth=2, color=style.INK, zorder=4, label="goal at 1 ms")
    axes.set_xscale("log")
    axes.set_yscale("log")
