"""episodes: the return of every episode of a run, or of the runs of a sweep."""

import numpy as np

from . import style
from .run_folder import RunFolder, RunFolderError
from .summary import settings_of
from .sweep import is_seed

WINDOW = 9  # episodes, of the running median
MANY = 30  # marks become smaller
MOST_CURVES = 6


def draw(folders, path):
    """Writes the picture: returns over episodes, and the rate of success if it is not the same in all.

    Of one run a dot an episode and the running median; of several the median and the quartiles of the runs, a
    curve for every combination of settings but the seed, up to MOST_CURVES.
    Returns a list of sentences about what is left out. Raises RunFolderError when no run has episodes.
    """
    tables = [(folder, _episodes(folder)) for folder in folders]
    groups = _groups([(folder, table) for folder, table in tables if table is not None and len(table["return"])])
    runs = [table for group in groups.values() for table in group]
    if not runs:
        raise RunFolderError("no episode has ended")
    successes = len({success for table in runs for success in table["success"]}) > 1
    with style.styled():
        figure = style.new_figure(7.0, 5.2 if successes else 3.2)
        panels = figure.subplots(2 if successes else 1, 1, sharex=True, squeeze=False)[:, 0]
        if len(runs) == 1:
            _one(panels, runs[0])
        else:
            for (name, group), colour in zip(groups.items(), style.group_colours(len(groups))):
                _several(panels, group, colour, name)
            panels[0].set_title(f"Median and quartiles of {len(runs) // len(groups)} runs", loc="left")
            if len(groups) > 1:
                style.legend_beside(panels[0])
        panels[0].set_ylabel("return")
        panels[-1].set_xlabel("episode")
        if successes:
            panels[1].set_ylabel("success rate")
            panels[1].set_ylim(-0.03, 1.03)
        figure.align_ylabels(panels)
        style.save(figure, path)
    return []


def _episodes(folder):
    try:
        return RunFolder(folder).episodes()
    except RunFolderError:
        return None


def _groups(runs):
    """The runs by their settings, without those that are the same in all, and without seeds."""
    settings = [settings_of(folder) for folder, _ in runs]
    keys = [key for key in dict.fromkeys(key for one in settings for key in one)
            if not is_seed(key) and len({one.get(key) for one in settings}) > 1]
    groups = {}
    for one, (_, table) in zip(settings, runs):
        name = ", ".join(f"{key.split('.')[-1]} {one.get(key, '-')}" for key in keys)
        groups.setdefault(name, []).append(table)
    return groups if len(groups) <= MOST_CURVES else {"": [table for group in groups.values() for table in group]}


def _one(panels, table):
    number, returns, success = table["episode"], table["return"], table["success"] > 0
    size = 5 if len(number) <= MANY else 3
    panels[0].plot(number, returns, linestyle="none", marker="o", markersize=size, color=style.SKY, clip_on=False)
    panels[0].plot(number, _running(returns, np.median), color=style.BLUE)
    panels[0].set_title(f"Running median{' and mean' if len(panels) > 1 else ''} of {WINDOW} episodes", loc="left")
    if len(panels) > 1:
        panels[1].plot(number, success, linestyle="none", marker="o", markersize=size, color=style.SKY, clip_on=False)
        panels[1].plot(number, _running(success.astype(float), np.mean), color=style.BLUE)


def _several(panels, runs, colour, name):
    """Up to the episode that half of the runs have reached."""
    length = int(np.median([len(table["return"]) for table in runs]))
    number = np.arange(1, length + 1)
    returns = [[table["return"][i] for table in runs if len(table["return"]) > i] for i in range(length)]
    low, median, high = np.transpose([np.percentile(values, (25, 50, 75)) for values in returns])
    panels[0].fill_between(number, low, high, color=colour, alpha=0.2, linewidth=0)
    panels[0].plot(number, median, color=colour, label=name)
    if len(panels) > 1:
        rate = [np.mean([table["success"][i] for table in runs if len(table["success"]) > i]) for i in range(length)]
        panels[1].plot(number, rate, color=colour, clip_on=False)


def _running(values, statistic):
    half = WINDOW // 2
    return [statistic(values[max(0, i - half):i + half + 1]) for i in range(len(values))]
