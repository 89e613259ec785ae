"""spikes.png: sensor, spikes, population rates and commands above one time axis."""

import dataclasses

import numpy as np

from . import style
from .run_folder import RunFolderError

MOST_COLUMNS = 2000  # of the sensor's image: more than the picture has pixels
MOST_TICKED_ROWS = 60  # of a raster drawn with ticks
MOST_DOTS = 30_000  # a group's; more are drawn as density
RATE_BIN_S = 0.01


@dataclasses.dataclass
class Labels:
    """Which process plays which part; None: found by name and content."""

    sensor: str = None
    network: str = None
    command: str = None


@dataclasses.dataclass
class Group:
    """Neurons that share a colour and a rate."""

    name: str
    times_s: np.ndarray
    rows: np.ndarray  # place in the raster
    size: int


def draw(run, path, labels=None, begin_s=None, end_s=None):
    """Writes the picture; returns a list of sentences about what is missing.

    Raises RunFolderError when there is neither sensor, network nor command.
    """
    labels = labels or Labels()
    missing = []
    sensor = _found(find_sensor, run, labels.sensor, missing)
    spikes = _found(find_network, run, labels.network, missing)
    command = _found(find_command, run, labels.command, missing)
    if sensor is None and spikes is None and command is None:
        raise RunFolderError("nothing to draw beside the trajectory: " + "; ".join(missing))
    _place_beams(run, sensor)
    window = _window(sensor, spikes, command, begin_s, end_s)
    panels = _panels(sensor, spikes, command, window)
    with style.styled():
        figure = style.new_figure(10.0, 1.0 + sum(height for height, _ in panels))
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False,
                               gridspec_kw={"height_ratios": [height for height, _ in panels]})
        for panel, (_, draw_panel) in zip(axes[:, 0], panels):
            draw_panel(figure, panel)
        axes[0, 0].set_xlim(*window)
        axes[-1, 0].set_xlabel("time (s)")
        figure.align_ylabels(axes[:, 0])
        style.save(figure, path)
    return missing


def find_sensor(run, label=None):
    """The signal that came from the robot."""
    return run.signal(label or _pick(run, ("sensor", "scan", "laser"), "sensor",
                                     lambda name: _has_signals(run, name)))


def find_command(run, label=None):
    """The signal that went to the robot."""
    return run.signal(label or _pick(run, ("command", "motor", "wheels", "decoder"), "command",
                                     lambda name: _has_signals(run, name)))


def find_network(run, label=None):
    """The streams of the controlling neurons; of any process with spikes when none is a network."""
    streams = run.spikes(label or _pick(run, ("network", "brain", "neurons"), "network",
                                        lambda name: bool(run.spikes(name)), any_other=True))
    if not streams:
        raise RunFolderError(f"'{run.path / (label + '.h5')}' has no spikes")
    return streams


def _has_signals(run, name):
    return any(signal.stream != "pace" for signal in run.signals(name))


def _pick(run, words, role, fits, any_other=False):
    for word in words:
        for name in run.labels:
            if word in name.lower() and fits(name):
                return name
    for name in run.labels if any_other else []:
        if fits(name):
            return name
    recorded = f"recorded: {', '.join(run.labels)}" if run.labels else "nothing is recorded"
    raise RunFolderError(f"no {role} in '{run.path}': {recorded}; write record=true into its "
                         f"section, or name it with --{role} LABEL")


def _found(find, run, label, missing):
    try:
        return find(run, label)
    except RunFolderError as error:
        missing.append(str(error))
        return None


def _window(sensor, spikes, command, begin_s, end_s):
    streams = ([sensor] if sensor else []) + (spikes or []) + ([command] if command else [])
    end = max(stream.until_s for stream in streams) if end_s is None else end_s
    begin = 0.0 if begin_s is None else begin_s
    if not begin < end:
        raise RunFolderError(f"there is nothing to draw from {begin:g} s to {end:g} s: the "
                             f"recordings go to {max(s.until_s for s in streams):g} s")
    return begin, end


def _panels(sensor, spikes, command, window):
    """Pairs of height in inches and a function that draws into (figure, axes)."""
    panels = []
    if sensor is not None:
        panels.append((2.2, lambda figure, axes: _draw_sensor(figure, axes, sensor, window)))
    if spikes is not None:
        groups = group_neurons(spikes)
        panels.append((2.2, lambda figure, axes: _draw_raster(axes, spikes, groups, window)))
        panels.append((1.5, lambda figure, axes: _draw_rates(axes, groups, window)))
    if command is not None:
        for channel in range(min(command.width, 4)):
            panels.append((1.2, lambda figure, axes, channel=channel:
                           _draw_channel(axes, command, channel, window)))
    return panels


def _draw_sensor(figure, axes, sensor, window):
    columns = np.linspace(*window, MOST_COLUMNS + 1)
    image = sensor.at(0.5 * (columns[:-1] + columns[1:])).T
    low, high, label = _angles(sensor)
    colours = style.value_map()
    shown = axes.imshow(image, aspect="auto", origin="lower", interpolation="nearest",
                        extent=(*window, low, high), cmap=colours)
    axes.set_ylabel(label)
    axes.set_title(_title("Sensor", sensor.label), loc="left")
    if "(°)" in label:
        axes.set_yticks(_angle_ticks(low, high))
    bar = figure.colorbar(shown, ax=axes, pad=0.01, aspect=14, fraction=0.03)
    bar.set_label(_reading(sensor))
    bar.outline.set_visible(False)


def _reading(sensor):
    if not _has_no_unit(sensor):
        return f"reading ({sensor.unit})"
    known = sensor.values[np.isfinite(sensor.values)]
    return "reading (normalised)" if np.all(np.abs(known) <= 1) else "reading"


def _place_beams(run, sensor):
    """Takes the angles of the beams from the robot's world where the recording has none.

    A scan longer than the sensor's port is cropped at its end, so the first beams are the same.
    """
    try:
        laser = run.world().get("laser")
    except RunFolderError:
        return  # the trajectory's picture says so
    if sensor is None or not laser or not 1 < sensor.width <= laser["beams"]:
        return
    for name in ("angle_min_rad", "angle_increment_rad"):
        sensor.annotations.setdefault(name, laser[name])


def _angles(sensor):
    """Lower and upper edge of the image, and what the axis shows."""
    beam = sensor.annotations
    if "angle_min_rad" in beam and "angle_increment_rad" in beam and sensor.width > 1:
        step = np.degrees(beam["angle_increment_rad"])
        first = np.degrees(beam["angle_min_rad"])
        low, high = first - step / 2, first + (sensor.width - 0.5) * step
        sides = "\nright ←  → left" if low < 0 < high else ""
        return low, high, "beam angle (°)" + sides
    return -0.5, sensor.width - 0.5, "beam (index)" if sensor.width > 1 else "channel (index)"


def _angle_ticks(low, high):
    step = 45 if high - low <= 200 else 90
    return np.arange(np.ceil(low / step - 0.02) * step, high + 0.02 * step, step)


def group_neurons(streams):
    """A group a stream when there are several populations, else the lower and the upper half."""
    groups = []
    if len(streams) > 1:
        base = 0
        for stream in streams:
            groups.append(Group(stream.stream, stream.times_s, base + stream.channels,
                                stream.width))
            base += stream.width
        return groups
    stream = streams[0]
    bounds = (0, stream.width // 2, stream.width) if stream.width > 1 else (0, stream.width)
    for first, last in zip(bounds[:-1], bounds[1:]):
        inside = (stream.channels >= first) & (stream.channels < last)
        name = f"neuron {first}" if last - first == 1 else f"neurons {first}–{last - 1}"
        groups.append(Group(name, stream.times_s[inside], stream.channels[inside], last - first))
    return groups


def _draw_raster(axes, streams, groups, window):
    rows = sum(group.size for group in groups)
    count = 0
    for group, colour in zip(groups, style.group_colours(len(groups))):
        shown = (group.times_s >= window[0]) & (group.times_s <= window[1])
        times, places = group.times_s[shown], group.rows[shown]
        count += len(times)
        if rows <= MOST_TICKED_ROWS:
            sparse = len(times) < 200 * group.size
            axes.vlines(times, places - 0.38, places + 0.38, color=colour,
                        linewidth=1.1 if sparse else 0.7, alpha=_opacity(len(times), group.size))
        elif len(times) <= MOST_DOTS:
            axes.plot(times, places, linestyle="none", marker="o", markersize=1.6,
                      markeredgewidth=0, color=colour)
        else:
            _draw_density(axes, times, places, rows, colour, window)
    axes.set_aspect("auto")
    axes.set_xlim(*window)
    axes.set_ylim(-0.7, rows - 0.3)
    axes.yaxis.get_major_locator().set_params(integer=True)
    axes.set_ylabel("neuron (index)")
    axes.set_title(_title("Spikes", streams[0].label, f"{_counted(rows, 'neuron')}, "
                          f"{_counted(count, 'spike')}"), loc="left")


def _title(part, label, more=""):
    """The process is named where its name is not the part it plays."""
    notes = [text for text in ("" if label.lower() == part.lower() else label, more) if text]
    return f"{part} ({': '.join(notes)})" if notes else part


def _counted(number, noun):
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _opacity(spikes, neurons):
    """So that a row with many spikes is shaded by their density and not one solid bar."""
    marks_that_fit = 800  # side by side in a row
    return float(np.clip(marks_that_fit / max(1, spikes / max(1, neurons)), 0.1, 1.0)) ** 0.7


def _draw_density(axes, times, places, rows, colour, window):
    """Where dots would lie on top of each other: the more spikes in a cell, the darker."""
    counts, _, _ = np.histogram2d(places, times, bins=(min(rows, 250), 700),
                                  range=((-0.5, rows - 0.5), window))
    dark = max(1.0, np.quantile(counts[counts > 0], 0.98))
    image = np.empty((*counts.shape, 4))
    image[..., :3] = style.rgb(colour)
    image[..., 3] = np.clip(counts / dark, 0.0, 1.0)
    axes.imshow(image, aspect="auto", origin="lower", interpolation="nearest",
                extent=(*window, -0.5, rows - 0.5))


def kernel_width_s(window):
    """Standard deviation of the rates' Gaussian: 50 ms, wider where that could not be seen."""
    return float(np.clip(np.round((window[1] - window[0]) / 300, 2), 0.05, 1.0))


def population_rate(group, window, kernel_s):
    """Times (s) and the rate a neuron (spikes/s), smoothed with a Gaussian of deviation kernel_s.

    The kernel is normalised by the part of it that lies inside the window, so the rate does not
    sag at the ends.
    """
    bins = max(1, int(round((window[1] - window[0]) / RATE_BIN_S)))
    counts, edges = np.histogram(group.times_s, bins=bins, range=window)
    reach = int(np.ceil(4 * kernel_s / RATE_BIN_S))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) * RATE_BIN_S / kernel_s) ** 2)
    smooth = np.convolve(counts, kernel)[reach:reach + bins]
    inside = np.convolve(np.ones(bins), kernel)[reach:reach + bins]
    width_s = (window[1] - window[0]) / bins
    return 0.5 * (edges[:-1] + edges[1:]), smooth / inside / width_s / max(1, group.size)


def _draw_rates(axes, groups, window):
    kernel_s = kernel_width_s(window)
    for group, colour in zip(groups, style.group_colours(len(groups))):
        axes.plot(*population_rate(group, window, kernel_s), color=colour, linewidth=1.3,
                  label=group.name)
    axes.set_ylim(bottom=0)
    axes.margins(y=0.08)
    axes.set_ylabel("rate\n(spikes/s)")
    axes.set_title(f"Mean rate of a neuron (Gaussian kernel, σ = {kernel_s * 1e3:.0f} ms)",
                   loc="left")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.98), ncol=len(groups), borderaxespad=0.2,
                handlelength=1.4)


def _draw_channel(axes, command, channel, window):
    first = max(0, np.searchsorted(command.times_s, window[0], side="right") - 1)
    last = np.searchsorted(command.times_s, window[1], side="right")
    values = command.values[first:last, channel]
    if len(values):
        times = np.append(command.times_s[first:last], min(command.until_s, window[1]))
        axes.step(times, np.append(values, values[-1]), where="post", color=style.INK,
                  linewidth=1.2)
    axes.axhline(0.0, color=style.SOFT, linewidth=0.6, linestyle=(0, (4, 3)), zorder=0)
    axes.margins(y=0.12)
    name, unit = _name_and_unit(command, channel)
    axes.set_ylabel(f"{name}\n({unit})")
    if channel == 0:
        axes.set_title(_title("Command", command.label), loc="left")


def _name_and_unit(command, channel):
    """A command of two channels without names is a Twist's speed ahead and yaw rate, in SI units."""
    names = command.channels or (["linear.x", "angular.z"] if command.width == 2 else [])
    name = names[channel] if names else f"channel {channel}"
    units = [unit.strip() for unit in command.unit.split(",")]
    if len(units) == command.width > 1:
        return name, units[channel]
    by_name = {"linear": "m/s", "angular": "rad/s"}
    return name, by_name.get(name.split(".")[0], "1") if _has_no_unit(command) else command.unit


def _has_no_unit(signal):
    return signal.unit in ("", "1")
