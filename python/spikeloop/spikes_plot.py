"""spikes.png: sensor, spikes, population rates and commands above one time axis."""

import dataclasses

import numpy as np

from . import panels, style
from .run_folder import RunFolderError

MOST_ROWS = 1000  # of a raster: of more neurons, every second or third, ... is drawn
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


def draw(run, path, labels=None, begin_s=None, end_s=None, found=None):
    """Writes the picture; returns a list of sentences about what is missing.

    found: parts.Parts, for what `labels` does not name; None: found by name and content.
    Raises RunFolderError when there is neither sensor, network nor command.
    """
    labels = labels or Labels()
    missing = []
    sensors = _chosen(find_sensor, run, labels.sensor, found and found.sensors, missing)
    streams = _chosen(find_network, run, labels.network, found and found.spikes, missing)
    commands = _chosen(find_command, run, labels.command, found and found.commands, missing)
    if not (sensors or streams or commands):
        raise RunFolderError("nothing to draw beside the trajectory: "
                             + "; ".join(missing or ["neither sensor, spikes nor command"]))
    for sensor in sensors:
        _place_beams(run, sensor)
    window = time_window(sensors + streams + commands, begin_s, end_s)
    drawn = _panels(sensors, streams, commands, window)
    with style.styled():
        figure = style.new_figure(10.0, 1.0 + sum(height for height, _ in drawn))
        axes = figure.subplots(len(drawn), 1, sharex=True, squeeze=False,
                               gridspec_kw={"height_ratios": [height for height, _ in drawn]})
        for panel, (_, draw_panel) in zip(axes[:, 0], drawn):
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


def _chosen(find, run, label, found, missing):
    """What the run is known to have, unless a label says otherwise."""
    if label is None and found is not None:
        return found
    try:
        chosen = find(run, label)
    except RunFolderError as error:
        missing.append(str(error))
        return []
    return chosen if isinstance(chosen, list) else [chosen]


def time_window(streams, begin_s, end_s):
    """Begin and end in seconds; the run's own where they are None."""
    until = max((stream.until_s for stream in streams), default=0.0)
    begin = 0.0 if begin_s is None else begin_s
    end = until if end_s is None else end_s
    if not begin < end or begin >= until:
        raise RunFolderError(f"there is nothing to draw from {begin:g} s to {end:g} s: the "
                             f"recordings go to {until:g} s")
    return begin, end


def _panels(sensors, streams, commands, window):
    """Pairs of height in inches and a function that draws into (figure, axes)."""
    drawn = [(2.2, lambda figure, axes, sensor=sensor: _draw_sensor(figure, axes, sensor, window))
             for sensor in sensors]
    rates = []
    for nodes in _by_label(streams):
        groups = group_neurons(nodes, halves=len(streams) == 1)
        colours = style.group_colours(len(rates) + len(groups))[len(rates):]
        rates += [(group, len(_by_label(streams)) > 1 and nodes[0].label) for group in groups]
        drawn.append((2.2 if len(streams) < 4 else 1.6,
                      lambda figure, axes, nodes=nodes, groups=groups, colours=colours:
                      _draw_raster(axes, nodes, groups, colours, window)))
    if rates:
        drawn.append((1.5, lambda figure, axes: _draw_rates(axes, rates, window)))
    for command in commands:
        drawn += [(1.2, lambda figure, axes, command=command, channel=channel:
                   _draw_channel(axes, command, channel, window))
                  for channel in range(min(command.width, 4))]
    return drawn


def _by_label(streams):
    """Lists of the streams of one node or process each."""
    labels = dict.fromkeys(stream.label for stream in streams)
    return [[stream for stream in streams if stream.label == label] for label in labels]


def _draw_sensor(figure, axes, sensor, window):
    low, high, label = _angles(sensor)
    if sensor.width <= panels.MOST_LINES and "(°)" not in label:
        panels.draw_lines(axes, sensor, window)
        axes.set_ylabel(_reading(sensor).replace(" (", "\n("))
    else:
        panels.draw_image(figure, axes, sensor, window, (low, high), _reading(sensor))
        axes.set_ylabel(label)
    axes.set_title(_title("Sensor", sensor.label), loc="left")
    if "(°)" in label:
        axes.set_yticks(_angle_ticks(low, high))


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


def group_neurons(streams, halves=True):
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
    if not halves:
        return [Group(stream.stream, stream.times_s, stream.channels, stream.width)]
    bounds = (0, stream.width // 2, stream.width) if stream.width > 1 else (0, stream.width)
    for first, last in zip(bounds[:-1], bounds[1:]):
        inside = (stream.channels >= first) & (stream.channels < last)
        name = f"neuron {first}" if last - first == 1 else f"neurons {first}–{last - 1}"
        groups.append(Group(name, stream.times_s[inside], stream.channels[inside], last - first))
    return groups


def every_nth(rows):
    """Of so many neurons, which are drawn: 3 is every third."""
    return max(1, -(-rows // MOST_ROWS))


def _draw_raster(axes, streams, groups, colours, window):
    rows = sum(group.size for group in groups)
    stride = every_nth(rows)
    count = 0
    for group, colour in zip(groups, colours):
        inside = (group.times_s >= window[0]) & (group.times_s <= window[1])
        count += int(inside.sum())
        shown = inside & (group.rows % stride == 0)
        times, places = group.times_s[shown], group.rows[shown]
        if rows <= MOST_TICKED_ROWS:
            sparse = len(times) < 200 * group.size
            axes.vlines(times, places - 0.38, places + 0.38, color=colour,
                        linewidth=1.1 if sparse else 0.7, alpha=_opacity(len(times), group.size),
                        rasterized=True)
        elif len(times) <= MOST_DOTS:
            axes.plot(times, places, linestyle="none", marker="o", markersize=1.6,
                      markeredgewidth=0, color=colour, rasterized=True)
        else:
            _draw_density(axes, times, places, (rows, stride), colour, window)
    axes.set_aspect("auto")
    axes.set_xlim(*window)
    axes.set_ylim(-0.7, rows - 0.3)
    axes.yaxis.get_major_locator().set_params(integer=True)
    axes.set_ylabel("neuron (index)")
    axes.set_title(_title("Spikes", streams[0].label, f"{_counted(rows, 'neuron')}, "
                          f"{_counted(count, 'spike')}{_of_which(stride)}"), loc="left")


def _title(part, label, more=""):
    """The process is named where its name is not the part it plays."""
    notes = [text for text in ("" if label.lower() == part.lower() else label, more) if text]
    return f"{part} ({': '.join(notes)})" if notes else part


def _of_which(stride):
    return "" if stride == 1 else f"; one neuron in {stride} is drawn"


def _counted(number, noun):
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _opacity(spikes, neurons):
    """So that a row with many spikes is shaded by their density and not one solid bar."""
    marks_that_fit = 800  # side by side in a row
    return float(np.clip(marks_that_fit / max(1, spikes / max(1, neurons)), 0.1, 1.0)) ** 0.7


def _draw_density(axes, times, places, size, colour, window):
    """Where dots would lie on top of each other: the more spikes in a cell, the darker."""
    rows, stride = size
    counts, _, _ = np.histogram2d(places, times, bins=(min(rows // stride, 250), 700),
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


def _draw_rates(axes, rates, window):
    """rates: pairs of a group and the label to name it by, where there are several."""
    kernel_s = kernel_width_s(window)
    several = len({label for _, label in rates}) < len(rates)
    lines = ("-", (0, (4, 2)))  # equal rates lie on top of each other
    for number, ((group, label), colour) in enumerate(zip(rates, style.group_colours(len(rates)))):
        name = f"{label}.{group.name}" if label and several else label or group.name
        axes.plot(*population_rate(group, window, kernel_s), color=colour, linewidth=1.3,
                  linestyle=lines[number > 0 and bool(label)], label=name)
    axes.set_ylim(bottom=0)
    axes.margins(y=0.08)
    axes.set_ylabel("rate\n(spikes/s)")
    axes.set_title(f"Mean rate of a neuron (Gaussian kernel, σ = {kernel_s * 1e3:.0f} ms)",
                   loc="left")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.98), ncol=len(rates), borderaxespad=0.2,
                handlelength=1.4)


def _draw_channel(axes, command, channel, window):
    axes.step(*panels.steps(command, channel, window), where="post", color=style.INK, linewidth=1.2)
    panels.draw_zero(axes)
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
