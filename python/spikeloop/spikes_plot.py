"""spikes: sensors, spikes and rates of every population, commands, above one time axis."""

import dataclasses

import numpy as np
from matplotlib.patches import Patch

from . import panels, style
from .run_folder import RunFolderError

MOST_POPULATIONS = 24  # of a node that are told apart
MOST_ROWS = 1000  # of a raster: of more neurons, every second or third, ... is drawn
MOST_TICKED_ROWS = 60  # of a raster drawn with ticks
MOST_TICKS = 250  # of a row; more would be one bar
MOST_DOTS = 30_000  # of a population; more are drawn as density
NAME_IN = 0.2  # height of a line of a legend


@dataclasses.dataclass
class Population:
    """Neurons that share a colour and a rate."""

    name: str
    times_s: np.ndarray
    rows: np.ndarray  # of the spikes in the raster
    size: int


def draw(parts, path, window):
    """Writes the picture of parts.Parts; returns a list of sentences about what is missing.

    Raises RunFolderError when there is neither sensor, spikes nor command.
    """
    drawn = _panels(parts, window)
    if not drawn:
        raise RunFolderError("neither sensor, spikes nor command is recorded")
    panels.draw_column(drawn, path, window)
    return []


def _panels(parts, window):
    """As panels.of_signal()."""
    drawn = [panel for sensor in parts.sensors
             for panel in panels.of_signal(sensor, _title("Sensor", sensor.label), window)]
    labels = dict.fromkeys(stream.label for stream in parts.spikes)
    first = 0
    for label in labels:
        found = populations([stream for stream in parts.spikes if stream.label == label])
        colours = style.group_colours(first + len(found))[first:]
        first += len(found)
        names = NAME_IN * len(found) + 0.5
        drawn += [(max(names, 1.9 if len(labels) < 4 else 1.5),
                   lambda figure, axes, label=label, found=found, colours=colours:
                   _draw_raster(axes, label, found, colours, window)),
                  (1.1, lambda figure, axes, found=found, colours=colours:
                   _draw_rates(axes, found, colours, window))]
    return drawn + [panel for command in parts.commands
                    for panel in panels.of_signal(command, _title("Command", command.label), window)]


def populations(streams):
    """Those of one node from the lowest row of the raster, each of them once.

    Port `out` of a network has the populations of its key `output`, those of `record` have their own
    ports; another node has one population.
    """
    found, base = {}, 0
    for stream in sorted(streams, key=lambda stream: stream.stream != "out"):
        whole = [(stream.label if len(streams) == 1 else stream.stream, stream.width)]
        first = 0
        for name, size in (stream.populations if len(stream.populations) <= MOST_POPULATIONS else []) or whole:
            if name not in found:
                inside = (stream.channels >= first) & (stream.channels < first + size)
                found[name] = Population(name, stream.times_s[inside],
                                         stream.channels[inside] - first + base, size)
                base += size
            first += size
    return list(found.values())


def every_nth(rows):
    """Of so many neurons, which are drawn: 3 is every third."""
    return max(1, -(-rows // MOST_ROWS))


def _draw_raster(axes, label, found, colours, window):
    rows = sum(population.size for population in found)
    stride = every_nth(rows)
    count = 0
    for population, colour in zip(found, colours):
        inside = (population.times_s >= window[0]) & (population.times_s <= window[1])
        count += int(inside.sum())
        shown = inside & (population.rows % stride == 0)
        times, places = population.times_s[shown], population.rows[shown]
        if rows <= MOST_TICKED_ROWS and len(times) <= MOST_TICKS * population.size:
            axes.vlines(times, places - 0.38, places + 0.38, color=colour, linewidth=1.0, rasterized=True)
        elif rows > MOST_TICKED_ROWS and len(times) <= MOST_DOTS:
            axes.plot(times, places, linestyle="none", marker="o", markersize=1.6,
                      markeredgewidth=0, color=colour, rasterized=True)
        else:
            _draw_density(axes, times, places, (rows, stride), colour, window)
    axes.set_aspect("auto")
    axes.set_xlim(*window)
    axes.set_ylim(-0.7, rows - 0.3)
    axes.yaxis.get_major_locator().set_params(integer=True)
    axes.set_ylabel("neuron (index)")
    axes.set_title(_title("Spikes", label, f"{_counted(rows, 'neuron')}, "
                          f"{_counted(count, 'spike')}{_of_which(stride)}"), loc="left")
    if len(found) > 1:
        style.legend_beside(axes, [Patch(color=colour, label=population.name)
                                   for population, colour in zip(found, colours)][::-1])


def _title(part, label, more=""):
    """The process is named where its name is not the part it plays."""
    notes = [text for text in ("" if label.lower() == part.lower() else label, more) if text]
    return f"{part} ({': '.join(notes)})" if notes else part


def _of_which(stride):
    return "" if stride == 1 else f"; one neuron in {stride} is drawn"


def _counted(number, noun):
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def _draw_density(axes, times, places, size, colour, window):
    """Where marks would lie on top of each other: the more spikes in a cell, the darker."""
    rows, stride = size
    lines = min(rows // stride, 250)
    columns = int(np.clip(len(times) / len(np.unique(places)) / 3, 100, 700))  # some spikes in a cell
    counts, _, _ = np.histogram2d(places, times, bins=(lines, columns), range=((-0.5, rows - 0.5), window))
    counts = np.apply_along_axis(np.convolve, 1, np.pad(counts, ((0, 0), (2, 2)), "edge"),
                                 np.array([1, 4, 6, 4, 1]) / 16, "valid")
    dark = max(1.0, np.quantile(counts[counts > 0], 0.98))
    image = np.empty((*counts.shape, 4))
    image[..., :3] = style.rgb(colour)
    image[..., 3] = np.clip(counts / dark, 0.0, 1.0)
    axes.imshow(image, aspect="auto", origin="lower", interpolation="nearest",
                extent=(*window, -0.5, rows - 0.5))


def kernel_width_s(window):
    """Standard deviation of the rates' Gaussian: 50 ms, about a hundredth of a long window (at most 1 s), and a
    twentieth of a short one."""
    whole = window[1] - window[0]
    length = min(1.0, max(whole / 100, min(0.05, whole / 20)))
    power = 10.0 ** np.floor(np.log10(length))
    return float(power * min((1, 2, 5, 10), key=lambda step: abs(np.log(step * power / length))))


def population_rate(population, window, kernel_s):
    """Times (s) and the rate a neuron (spikes/s), smoothed with a Gaussian of deviation kernel_s.

    The kernel is normalised by the part of it that lies inside the window, so the rate does not
    sag at the ends.
    """
    bins = max(1, int(round((window[1] - window[0]) / kernel_s * 5)))
    counts, edges = np.histogram(population.times_s, bins=bins, range=window)
    width_s = (window[1] - window[0]) / bins
    reach = int(np.ceil(4 * kernel_s / width_s))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) * width_s / kernel_s) ** 2)
    smooth = np.convolve(counts, kernel)[reach:reach + bins]
    inside = np.convolve(np.ones(bins), kernel)[reach:reach + bins]
    return 0.5 * (edges[:-1] + edges[1:]), smooth / inside / width_s / max(1, population.size)


def _draw_rates(axes, found, colours, window):
    kernel_s = kernel_width_s(window)
    for number, (population, colour) in enumerate(zip(found, colours)):
        axes.plot(*population_rate(population, window, kernel_s), color=colour, linewidth=1.3,
                  linestyle=("-", (0, (4, 2)))[number % 2])  # equal rates lie on top of each other
    axes.set_ylim(bottom=0)
    axes.margins(y=0.08)
    axes.locator_params(axis="y", nbins=4, min_n_ticks=3)
    axes.set_ylabel("rate\n(spikes/s)")
    width = f"{kernel_s:g} s" if kernel_s >= 1 else f"{kernel_s * 1e3:g} ms"
    axes.set_title(f"Mean rate of a neuron (Gaussian kernel, σ = {width})", loc="left")
