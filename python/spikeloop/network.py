"""Networks of the built-in simulator from a Python function: `network: brain.py:make`.

    import numpy as np
    import spikeloop.network

    def make():
        net = spikeloop.network.Network(resolution="0.1 ms")
        net.population("input", "input", 100)
        net.population("cell", "iaf_psc_exp", 20, tau_m="15 ms")
        weights = np.random.default_rng(1).uniform(0, 50, size=(20, 100))
        net.connect("input", "cell", weights, delay="1.5 ms")
        net.output("cell")
        return net

Models, parameters, rules and units are those of the network file (docs/network-file.md). The function
runs once whenever the file is read, in a Python of its own: what is random in it needs a seed.

Its arguments are keys of the node: `def make(weight=spikeloop.Parameter(20, unit="pA"), cells=50)`.
"""

import importlib.util
import inspect
import json
import math
import os
import pathlib
import sys
import traceback

import numpy as np

from .declare import Parameter, script_parameter


class Network:
    """Populations, connections, and what leaves: `spikeloop-network --check brain.py:make` shows it."""

    def __init__(self, resolution="0.1 ms"):
        """`resolution`: the grid, "0.1 ms" or a number of ms, or "off"."""
        self._file = {"resolution": _written(resolution), "populations": {}, "connections": []}
        self._lines = {}  # of the calls, by what they wrote
        self._tables = []  # of the connections that have one, by their index

    def population(self, name, model, size, **parameters):
        """A population of `size` members; returns its name. Parameters are numbers in NEST's units
        or text with a unit; rates and currents that change are lists of (time, value)."""
        if name in self._file["populations"]:
            raise ValueError(f"there are two populations '{name}'; give each a name of its own")
        entry = {"model": model, "size": _whole(f"the size of '{name}'", size)}
        if parameters:
            entry["parameters"] = {key: _written(value) for key, value in parameters.items()}
        self._file["populations"][name] = entry
        self._lines["populations", name] = _line()
        return name

    def connect(self, source, target, weights=None, *, rule=None, weight=None, delay=None,
                plasticity=None):
        """Connects two populations.

        `weights`: an array [targets, sources], in mV, in pA or without unit (see the models), 0
        meaning no synapse; or a triple (sources, targets, weights) of three lists, where a weight may
        be 0 and a pair may stand there twice. Without it, `rule` and `weight` are those of the network
        file. `delay`: ms, or text with a unit; none of a current; rates may have none. `plasticity`: a
        dictionary as in the network file.
        """
        for end in (source, target):
            if end not in self._file["populations"]:
                raise ValueError(f"there is no population '{end}'; call population() first")
        if (weights is None) == (rule is None):
            raise ValueError(f"{source} -> {target}: write either weights or a rule")
        entry = {"from": source, "to": target}
        if rule is not None:
            entry["rule"] = rule
        if weight is not None:
            entry["weight"] = _written(weight)
        if delay is not None:
            entry["delay"] = _written(delay)
        if plasticity is not None:
            entry["plasticity"] = {key: _written(value) for key, value in plasticity.items()}
        if weights is not None:
            self._add_weights(entry, source, target, weights)
        self._lines["connections", len(self._file["connections"])] = _line()
        self._file["connections"].append(entry)

    def output(self, *populations):
        """Their spikes leave by port `out`, in this order."""
        self._lines["output"] = _line()
        self._file.setdefault("output", []).extend(populations)

    def potential(self, *populations):
        """Their membrane potentials leave by port `potential`, in mV."""
        self._lines["potential"] = _line()
        self._file.setdefault("potential", []).extend(populations)

    def rates(self, *populations):
        """Their rates leave by port `rates`, in this order."""
        self._lines["rates"] = _line()
        self._file.setdefault("rates", []).extend(populations)

    def record(self, population, spikes=False, V_m=None, interval=None):
        """Records spikes, and membrane potentials: "all", or a list of members, every `interval`."""
        entry = {"spikes": bool(spikes)}
        if V_m is not None:
            entry["V_m"] = V_m if isinstance(V_m, str) else [
                _whole(f"a member of '{population}'", member) for member in V_m]
        if interval is not None:
            entry["interval"] = _written(interval)
        self._file.setdefault("record", {})[population] = entry
        self._lines["record", population] = _line()

    def write(self, folder):
        """Writes network.json, a network file, the weights that it names, and for each of its lines
        the line of the call behind it; returns its path."""
        folder = pathlib.Path(folder).resolve()
        for number, table in self._tables:
            name = folder / f"weights-{number}{'.npy' if isinstance(table, np.ndarray) else '.json'}"
            if isinstance(table, np.ndarray):
                np.save(name, table)
            else:
                name.write_text(json.dumps(table))
            self._file["connections"][number]["rule"] = str(name)
        path = folder / "network.json"
        lines = list(self._written_lines())
        path.write_text("\n".join(text for text, _ in lines))
        (folder / "lines").write_text("\n".join(str(line) for _, line in lines))
        return path

    def _written_lines(self):
        """A line an entry, so that an error in one leads to the call that made it."""
        yield "{", 0
        for number, (key, value) in enumerate(self._file.items()):
            comma = "," if number + 1 < len(self._file) else "}"
            if not value or not isinstance(value, (dict, list)) or isinstance(value[0] if isinstance(
                    value, list) else None, str):
                yield f"{json.dumps(key)}: {json.dumps(value)}{comma}", self._lines.get(key, 0)
                continue
            braces = "{}" if isinstance(value, dict) else "[]"
            yield f"{json.dumps(key)}: {braces[0]}", 0
            names = list(value) if isinstance(value, dict) else range(len(value))
            for place, name in enumerate(names):
                label = f"{json.dumps(name)}: " if isinstance(value, dict) else ""
                end = "," if place + 1 < len(names) else ""
                yield f"{label}{json.dumps(value[name])}{end}", self._lines.get((key, name), 0)
            yield braces[1] + comma, 0

    def _size(self, name):
        return self._file["populations"][name]["size"]

    def _unit(self, source, target):
        """What one of the numbers of an array is, as the key `weight` says it."""
        model = {name: self._file["populations"][name]["model"] for name in (source, target)}
        if (model[source].endswith("_current") or model[target] == "repeater"
                or model[target].endswith("_rate_ipn")):
            return 1
        return "1 pA" if model[source] == "signal_input" else (
            "1 mV" if model[target] == "iaf_psc_delta" else "1 pA")

    def _add_weights(self, entry, source, target, weights):
        what = f"{source} -> {target}"
        shape = self._size(target), self._size(source)
        entry.setdefault("weight", self._unit(source, target))
        if isinstance(weights, tuple):
            self._add_triple(entry, what, shape, weights)
            return
        table = _real(what, weights)
        if table.shape != shape:
            raise ValueError(f"{what}: the weights have the shape {table.shape}, but there are "
                             f"{shape[0]} targets and {shape[1]} sources; make them {shape}")
        self._tables.append((len(self._file["connections"]), table))

    def _add_triple(self, entry, what, shape, triple):
        if len(triple) != 3 or len({len(part) for part in triple}) != 1:
            raise ValueError(f"{what}: weights are no triple of equally long lists; write "
                             "(sources, targets, weights)")
        sources, targets = (np.array([_whole(f"{what}: a {name}", member) for member in part],
                                     dtype=np.int64)
                            for name, part in zip(("source", "target"), triple))
        values = _real(what, triple[2])
        for name, members, size in (("source", sources, shape[1]), ("target", targets, shape[0])):
            wrong = members[(members < 0) | (members >= size)]
            if len(wrong):
                raise ValueError(f"{what}: there is no {name} {wrong[0]}; they count from 0 to "
                                 f"{size - 1}")
        pairs = [[int(s), int(t), float(w)] for s, t, w in zip(sources, targets, values)]
        if len(np.unique(sources * shape[0] + targets)) < len(pairs):
            entry["rule"], entry["pairs"] = "pairs", pairs
            return
        table = {"rows": shape[0], "columns": shape[1], "entries": [[t, s, w] for s, t, w in pairs]}
        self._tables.append((len(self._file["connections"]), table))


def _line():
    """Of the first call from outside this file."""
    frame = sys._getframe(1)
    while frame.f_code.co_filename == __file__ and frame.f_back is not None:
        frame = frame.f_back
    return frame.f_lineno


def _whole(what, number):
    """2, np.int32(2) or 2.0 as 2: nothing is rounded."""
    if isinstance(number, (int, np.integer)) or (
            isinstance(number, (float, np.floating)) and float(number).is_integer()):
        return int(number)
    raise ValueError(f"{what} is {number}; write a whole number")


def _real(what, weights):
    """The weights as finite numbers: no part of one is lost."""
    if np.iscomplexobj(weights):
        raise ValueError(f"{what}: the weights are complex numbers; write real ones, such as "
                         "weights.real")
    values = np.asarray(weights, dtype=float)
    if not np.isfinite(values).all():
        raise ValueError(f"{what}: the weights hold {values[~np.isfinite(values)][0]}; they must be "
                         "finite")
    return values


def _written(value):
    """A value as a network file has it."""
    if isinstance(value, (list, tuple, np.ndarray)):
        return [_written(entry) for entry in value]
    return value.item() if isinstance(value, np.generic) else value


class _Fault(Exception):
    """What is wrong with the file itself: the line, and a sentence."""

    def __init__(self, line, text):
        super().__init__(text)
        self.line = line


def _function(path, name):
    spec = importlib.util.spec_from_file_location(pathlib.Path(path).stem, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    # A change that keeps the size of a file, within a second, would not be seen.
    sys.dont_write_bytecode = True
    sys.path.append(os.path.dirname(os.path.abspath(path)))  # last: a numpy.py there hides nothing
    spec.loader.exec_module(module)
    function = getattr(module, name, None)
    if not callable(function):
        there = [key for key, value in vars(module).items()
                 if callable(value) and getattr(value, "__module__", "") == spec.name]
        raise _Fault(0, f"there is no function '{name}'; " + (
            f"known: {', '.join(there)}" if there else f"write  def {name}():"))
    return function


def _note_files(path):
    """A set that gets every file in the folder of the script, or below, that Python opens to read."""
    root, files = os.path.join(os.path.realpath(os.path.dirname(path)), ""), set()

    def note(event, arguments):
        if event == "open" and isinstance(arguments[0], str) and not arguments[2] & (os.O_WRONLY | os.O_RDWR):
            file = os.path.realpath(arguments[0])
            if file.startswith(root) and os.path.isfile(file) and not file.endswith(".pyc"):
                files.add(file)

    sys.addaudithook(note)
    return files


def _arguments(function, name):
    """{argument: its Parameter, its default}. An argument without a default, or with one that is no
    parameter's, has a Parameter of text: it gets its value as it is written."""
    found = {}
    for argument in inspect.signature(function).parameters.values():
        default = argument.default
        if argument.kind in (argument.VAR_POSITIONAL, argument.VAR_KEYWORD):
            continue
        if isinstance(default, (Parameter, bool, int, float, str)):
            parameter = script_parameter(argument.name, default)
        else:
            parameter = Parameter(type=str) if default is argument.empty else Parameter("")
        parameter.text = parameter.text or f"Argument of {name}()"
        found[argument.name] = parameter, default
    return found


def _write_parameters(arguments, folder):
    """As the C++ side reads it; a bound that there is not is null."""
    declared = [[None if isinstance(part, float) and math.isinf(part) else part
                 for part in parameter.plain(name)] for name, (parameter, _) in arguments.items()]
    pathlib.Path(folder, "parameters").write_text(json.dumps(declared), encoding="utf-8")


def _value(written, parameter, default):
    """The value of an argument: of its Parameter's type; a whole number stays one where the default
    is one. Without either, a number, a list or a truth value is one, and all else a text."""
    if written is None:
        return parameter.default if default is parameter else default
    if isinstance(default, Parameter) or isinstance(default, (bool, float, str)):
        return written
    if isinstance(default, int):
        return int(written) if written.is_integer() else written
    try:
        return json.loads(written)
    except ValueError:
        return written


def _run(path, name, folder):
    files = _note_files(path)
    function = _function(path, name)
    arguments, values = _arguments(function, name), pathlib.Path(folder, "values")
    if arguments and not values.exists():
        _write_parameters(arguments, folder)
        return
    written = json.loads(values.read_text(encoding="utf-8")) if arguments else {}
    network = function(**{key: _value(written.get(key), *argument)
                          for key, argument in arguments.items()})
    if not isinstance(network, Network):
        line = getattr(getattr(function, "__code__", None), "co_firstlineno", 0)
        raise _Fault(line, f"the function '{name}' returned {type(network).__name__}, no "
                           "spikeloop.network.Network; write  return net")
    pathlib.Path(folder, "files").write_text("\n".join(sorted(files)), encoding="utf-8")
    network.write(folder)


def _told(path, error):
    """The line of the user's file at which it went wrong; what, and the calls that led there."""
    if isinstance(error, _Fault):
        return error.line, str(error)
    what = traceback.format_exception_only(type(error), error)[-1].strip()
    what = (f"Python was ended before the function was over: {what}"
            if isinstance(error, SystemExit) else f"Python says: {what}")
    own = os.path.realpath(path)
    frames = [(os.path.realpath(frame.filename), frame)
              for frame in traceback.extract_tb(error.__traceback__)]
    inside = [i for i, (file, _) in enumerate(frames) if file == own]
    if not inside:
        return getattr(error, "lineno", None) or 0, what
    calls = [f"line {frame.lineno}" + ("" if file == own else f" of {file}") + f" in {frame.name}"
             for file, frame in frames[inside[0]:] if file != os.path.realpath(__file__)]
    return frames[inside[-1]][1].lineno, f"{what}; at {', called at '.join(calls[::-1])}"


def _main(path, name, folder):
    try:
        _run(path, name, folder)
        return 0
    except (Exception, SystemExit) as error:  # pylint: disable=broad-except
        line, text = _told(path, error)
        pathlib.Path(folder, "fault").write_text(f"{line}\n{text}", encoding="utf-8")
        return 3


if __name__ == "__main__":
    # The class that the user's file imports, not that of __main__.
    from spikeloop import network as imported
    sys.exit(imported._main(*sys.argv[1:]))
