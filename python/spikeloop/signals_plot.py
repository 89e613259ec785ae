"""signals: what nodes between sensors and commands put out, above one time axis."""

from . import panels
from .run_folder import RunFolderError

MOST_SIGNALS = 12


def draw(parts, path, window):
    """Writes the picture; returns a list of sentences about what is left out.

    Raises RunFolderError when there is no such signal.
    """
    if not parts.signals:
        raise RunFolderError("no signal between sensors and commands is recorded")
    panels.draw_column([panel for signal in parts.signals[:MOST_SIGNALS]
                        for panel in panels.of_signal(signal, _title(signal), window)], path, window)
    return [f"signal '{signal.label}.{signal.stream}' is left out of {path.name}: it shows "
            f"{MOST_SIGNALS}" for signal in parts.signals[MOST_SIGNALS:]]


def _title(signal):
    return signal.label if signal.stream == "out" else f"{signal.label}.{signal.stream}"
