"""signals: what nodes between sensors and commands put out, a panel each above one time axis."""

from . import panels, style
from .run_folder import RunFolderError

MOST_PANELS = 12


def draw(parts, path, window):
    """Writes the picture; returns a list of sentences about what is left out.

    Raises RunFolderError when there is no such signal.
    """
    signals = parts.signals[:MOST_PANELS]
    if not signals:
        raise RunFolderError("no signal between sensors and commands is recorded")
    heights = [1.5 if signal.width <= panels.MOST_LINES else 2.0 for signal in signals]
    with style.styled():
        figure = style.new_figure(10.0, 0.9 + sum(heights))
        axes = figure.subplots(len(signals), 1, sharex=True, squeeze=False,
                               gridspec_kw={"height_ratios": heights})[:, 0]
        for panel, signal in zip(axes, signals):
            _draw_signal(figure, panel, signal, window)
        axes[0].set_xlim(*window)
        axes[-1].set_xlabel("time (s)")
        figure.align_ylabels(axes)
        style.save(figure, path)
    return [f"signal '{signal.label}.{signal.stream}' is left out of {path.name}: it shows "
            f"{MOST_PANELS}" for signal in parts.signals[MOST_PANELS:]]


def _draw_signal(figure, axes, signal, window):
    title = signal.label if signal.stream == "out" else f"{signal.label}.{signal.stream}"
    if signal.width <= panels.MOST_LINES:
        panels.draw_lines(axes, signal, window)
        axes.set_ylabel(panels.unit_text(signal))
    else:
        panels.draw_image(figure, axes, signal, window, (-0.5, signal.width - 0.5),
                          panels.unit_text(signal))
        axes.set_ylabel("channel (index)")
        axes.yaxis.get_major_locator().set_params(integer=True)
    axes.set_title(title, loc="left")
