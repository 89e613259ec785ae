"""What the entries of results.json have: checked when it is read, since it may have been edited."""

from . import chain, simulators


class EntryError(Exception):
    """Which entry is not as it should be, and how."""


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _number(value):
    return "" if _is_number(value) else "a number"


def _number_or_null(value):
    return "" if value is None or _is_number(value) else "a number or null"


def _flag(value):
    return "" if isinstance(value, bool) else "true or false"


def _text(value):
    return "" if isinstance(value, str) else "text"


def _list(value):
    return "" if isinstance(value, list) else "a list"


def _object(value):
    return "" if isinstance(value, dict) else "an object"


def _one_of(names):
    names = tuple(names)
    return lambda value: "" if value in names else f"one of {', '.join(names)}"


LAYOUT = {"layout": _one_of(("fused", "separate", "alone")), "tick_ms": _number}
CURVE = {**LAYOUT, "encoder": _one_of(chain.ENCODERS), "simulator": _one_of(simulators.NAMES),
         "rate_min_hz": _number, "rate_max_hz": _number, "duration_s": _number}
LATENCY = {**LAYOUT, "network": _flag, "answered": _number, "trials": _number,
           "min_ms": _number, "median_ms": _number, "p99_ms": _number}
LACK = {"reason": _text, "failed": _flag}


def check(known):
    """Raises EntryError for what lacks a key or has another type than what was written."""
    _check("the file", known, {"duration_s": _number, "machine": _object, "points": _list,
                               "latencies": _list, "largest": _list, "not_measured": _list})
    for where, point in _each(known, "points"):
        _check(where, point, {**CURVE, "neurons": _number, "trials": _list})
        for number, trial in enumerate(point["trials"]):
            _check(f"{where}.trials[{number}]", trial, {"real_time_factor": _number})
        _check(where, point,
               {"real_time_factor": _number if point["trials"] else _number_or_null})
    for where, row in _each(known, "latencies"):
        _check(where, row, LATENCY)
    for where, entry in _each(known, "largest"):
        _check(where, entry, {**CURVE, "neurons": _number, "next": _number_or_null})
    for where, entry in _each(known, "not_measured"):
        _check(where, entry, LACK)
        _check(where, entry, CURVE if "encoder" in entry else LAYOUT)


def _each(known, name):
    return ((f"{name}[{number}]", entry) for number, entry in enumerate(known[name]))


def _check(where, entry, keys):
    if wanted := _object(entry):
        raise EntryError(f"{where} is not {wanted}")
    for name, wanted_of in keys.items():
        if name not in entry:
            raise EntryError(f"{where} has no '{name}'")
        if wanted := wanted_of(entry[name]):
            raise EntryError(f"'{name}' of {where} is {_shown(entry[name])}, not {wanted}")


def _shown(value):
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."
