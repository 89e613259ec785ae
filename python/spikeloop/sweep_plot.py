"""sweep: each measure of a sweep over the swept key, from its table (sweep.py)."""

import collections
import csv
import json
import re

import numpy as np

from . import style
from .run_folder import RunFolderError
from .summary import ROWS
from .sweep import STATE, TABLE, is_seed

TIMING = ("simulated_s", "wall_s", "real_time_factor")  # of the computation, not of the robot
MOST_CURVES, MOST_TICKS = 12, 8


def draw(folder, path):
    """Writes the picture: a panel a measure that varies, median and quartiles of the runs with one value.

    Of several swept keys the one with the most values is the horizontal axis, the others give curves, up
    to MOST_CURVES. A random design (--samples) has a dot a run, and a column a key.
    Raises RunFolderError when nothing but seeds was swept, or no measure differs.
    """
    keys, measures, rows = _read(folder)
    keys = [key for key in keys if not is_seed(key) and _differ(rows, key)]
    keys.sort(key=lambda key: -len({row[key] for row in rows}))
    measures = [measure for measure in measures if measure not in TIMING and _differ(rows, measure)]
    if not keys or not measures:
        raise RunFolderError("no key but the seed has several values" if not keys else
                             "no measure differs from run to run")
    random = _is_random(folder)
    curves = len({tuple(row[key] for key in keys[1:]) for row in rows})
    columns, others = (keys, []) if random else (keys[:1], keys[1:] if curves <= MOST_CURVES else [])
    with style.styled():
        figure = style.new_figure(2.5 + 4.5 * len(columns), 0.8 + 1.8 * len(measures))
        panels = figure.subplots(len(measures), len(columns), sharex="col", sharey="row", squeeze=False)
        for column, key in enumerate(columns):
            for axes, measure in zip(panels[:, column], measures):
                _draw(axes, rows, key, others, measure, not random)
            _finish_column(panels[:, column], rows, key)
        for axes, measure in zip(panels[:, 0], measures):
            axes.set_ylabel(_label(measure))
        panels[0, 0].set_title("" if random else _statistics(rows, keys[:1] + others), loc="left")
        if others:
            style.legend_beside(panels[0, -1])
        figure.align_ylabels(panels[:, 0])
        style.save(figure, path)
    return []


def _read(folder):
    """Swept keys, measures, and the rows of the runs that finished."""
    try:
        with open(folder / TABLE, newline="", encoding="utf-8-sig") as file:
            table = csv.DictReader(file)
            rows = [row for row in table if row["exit_code"] == "0"]
        columns = table.fieldnames
        return columns[1:columns.index("exit_code")], columns[columns.index("exit_reason") + 1:], rows
    except (OSError, ValueError, KeyError, TypeError, csv.Error) as error:
        raise RunFolderError(f"'{folder / TABLE}' cannot be read: {error}") from None


def _is_random(folder):
    try:
        return json.loads((folder / STATE).read_text(encoding="utf-8")).get("samples") is not None
    except (OSError, ValueError, AttributeError):
        return False  # a table alone


def _differ(rows, column):
    return len({row[column] for row in rows if row[column]}) > 1


def _label(measure):
    """"distance driven (m)"; a counter has its own name."""
    for key, label, unit, _ in ROWS:
        if key == measure:
            return label.replace(", ", ",\n") + (f"\n({unit})" if unit else "")
    return measure


def _places(rows, key):
    """Where each value of a key stands, the unit, and whether the values are numbers of one unit."""
    texts = list(dict.fromkeys(row[key] for row in rows))
    matched = [re.fullmatch(r"\s*([-+.\deE]+)\s*([A-Za-z/%]*)\s*", text) for text in texts]
    units = {match[2] for match in matched if match}
    try:
        if all(matched) and len(units) == 1:
            return {text: float(match[1]) for text, match in zip(texts, matched)}, units.pop(), True
    except ValueError:
        pass  # "e-", which is no number
    return {text: place for place, text in enumerate(texts)}, "", False


def _draw(axes, rows, key, others, measure, connected):
    places, _, numbers = _places(rows, key)
    factor = 100 if measure == "coverage" else 1
    curves = {}
    for row in rows:
        if row[measure]:
            curve = curves.setdefault(", ".join(f"{other.split('.')[-1]} {row[other]}" for other in others), {})
            curve.setdefault(places[row[key]], []).append(factor * float(row[measure]))
    for (name, curve), colour in zip(curves.items(), style.group_colours(len(curves))):
        if not connected:
            axes.plot(*zip(*((place, value) for place in curve for value in curve[place])), ".", color=colour)
            continue
        place = sorted(curve)
        low, median, high = np.transpose([np.percentile(curve[at], (25, 50, 75)) for at in place])
        axes.errorbar(place, median, (median - low, high - median), color=colour, label=name, marker="o",
                      markersize=4, capsize=3, clip_on=False, linestyle="-" if numbers else "none")


def _finish_column(panels, rows, key):
    places, unit, numbers = _places(rows, key)
    panels[-1].set_xlabel(f"{key} ({unit})" if unit else key)
    if not numbers or len(places) <= MOST_TICKS:
        panels[-1].set_xticks(list(places.values()), [f"{place:g}" for place in places.values()] if numbers else places)
    for axes in panels:
        if axes.dataLim.intervaly[0] >= 0:
            axes.set_ylim(bottom=0)


def _statistics(rows, keys):
    """What the marks are: "Median and quartiles of 8 runs"; nothing where each is a run."""
    counts = set(collections.Counter(tuple(row[key] for key in keys) for row in rows).values())
    if counts == {1}:
        return ""
    return f"Median and quartiles of {'' if len(counts) == 1 else 'up to '}{max(counts)} runs"
