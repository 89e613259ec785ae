"""What tables and pictures show, picked from results.json."""

from . import paper, sweeps


def curve(document, layout, encoder, simulator, tick_ms):
    """Points of one curve of part a or d, by the number of neurons."""
    return sorted((point for point in points(document)
                   if (point["layout"], point["encoder"], point["simulator"], point["tick_ms"])
                   == (layout, encoder, simulator, tick_ms)
                   and (point["rate_min_hz"], point["rate_max_hz"]) == sweeps.RATES_HZ),
                  key=lambda point: point["neurons"])


def by_rate(document, layout):
    """Points of part b, by the rate."""
    found = [point for point in points(document)
             if point["layout"] == layout and point["rate_min_hz"] == point["rate_max_hz"]]
    most = max((point["neurons"] for point in found), default=0)
    return sorted((point for point in found if point["neurons"] == most),
                  key=lambda point: point["rate_max_hz"])


def points(document):
    """Those with a trial, of runs as long as the newest ones."""
    return [point for point in document["points"]
            if point["trials"] and point["duration_s"] == document["duration_s"]]


def largest(document, layout, encoder, simulator, tick_ms):
    """The entry of a curve, or None."""
    for entry in document["largest"]:
        if (entry["layout"], entry["encoder"], entry["simulator"], entry["tick_ms"],
                entry["duration_s"]) == (layout, encoder, simulator, tick_ms,
                                         document["duration_s"]):
            return entry
    return None


def highest_rate(document, layout):
    """The last rate of part b up to which all were in real time; 0: none; None: not measured."""
    found, highest = by_rate(document, layout), 0
    for point in found:
        if point["real_time_factor"] < 1:
            break
        highest = point["rate_max_hz"]
    return highest if found else None


def spread(point):
    """Least and largest factor of the trials."""
    factors = [trial["real_time_factor"] for trial in point["trials"]]
    return min(factors), max(factors)


def is_bound(point):
    """Whether its factor is an upper bound only: a job of several processes that was stopped."""
    return point["layout"] != "fused" and any(trial.get("stopped") for trial in point["trials"])


def goal(layout, name, simulator="none"):
    """A goal of this project, or None: they hold without a simulator."""
    return paper.GOALS.get(layout, {}).get(name) if simulator == "none" else None


def layouts(document):
    return [layout for layout in ("fused", "separate")
            if any(point["layout"] == layout for point in points(document))]


def used(document, name, among):
    """Which of `among` any point has under this name, in that order."""
    found = {point[name] for point in points(document)}
    return [value for value in among if value in found]


