"""What a node is, as data: its ports, its parameters, one line of text.

Two forms, with the same meaning. A function, for a node without memory:

    @spikeloop.node(inputs={"in": "signal"}, outputs={"out": "signal"}, gain=2.0)
    def gain(step, gain): ...

A class, for one with memory; parameters are attributes, and already have their values in __init__:

    @spikeloop.node
    class MyRateEncoder:
        inputs = {"in": spikeloop.Signal()}
        outputs = {"out": spikeloop.Spikes(same_as="in")}
        rate_max = spikeloop.Parameter(100, unit="Hz", minimum=0, text="Firing rate at 1")

        def __init__(self, setup): ...       # or without setup: name, seed, widths, random()
        def step(self, step): ...            # once an interval; see spikeloop.steps.Step
        def counters(self): return {...}     # may be left out; whole numbers since the start

Needs no NumPy, so that importing the package is cheap.
"""

import dataclasses
import difflib
import functools
import inspect
import math
import re
import sys

SECOND = 1_000_000_000  # nanoseconds; all times are whole nanoseconds

UNITS = ("", "1", "ns", "us", "ms", "s", "min", "h", "Hz", "kHz", "MHz", "uV", "mV", "V", "pA",
         "nA", "uA", "mA", "A", "pF", "nF", "uF", "Ohm", "kOhm", "MOhm", "GOhm", "mm", "cm", "m",
         "km", "rad", "deg", "m/s", "rad/s", "deg/s")
_TYPES = {float: "number", int: "integer", bool: "boolean", str: "text"}
_MICRO = ("\N{MICRO SIGN}", "\N{GREEK SMALL LETTER MU}")
_REQUIRED = object()


class NodeError(Exception):
    """A declaration, or what a node did, is wrong; the text says what, and what to write."""


def _with_ascii_micro(unit):
    """"us" for both letters of micro, as in C++."""
    return "u" + unit[1:] if isinstance(unit, str) and unit.startswith(_MICRO) else unit


def did_you_mean(word, candidates):
    """"; did you mean 'tau'?" or "; known: a, b"; ends an error message."""
    near = difflib.get_close_matches(str(word), candidates, n=1)
    if near:
        return f"; did you mean '{near[0]}'?"
    return f"; known: {', '.join(candidates)}" if candidates else ""


@dataclasses.dataclass(frozen=True)
class Signal:
    """A continuous port: a vector of float64, by convention in [-1, 1].

    width: number of channels; without it, as many as the connection has.
    same_as: name of the port of this node that is as wide.
    text: one line for `spikeloop describe`.
    """

    width: int = None
    same_as: str = None
    text: str = ""
    kind = "signal"

    def __post_init__(self):
        if self.width is not None and self.same_as is not None:
            raise NodeError(f"a port has width={self.width} and same_as='{self.same_as}'; "
                            "write one of them")
        width = self.width
        if width is not None and (isinstance(width, bool) or not isinstance(width, int)
                                  or not 1 <= width < 2**31):
            raise NodeError(f"a port has width={width!r}; write a whole number from 1, or leave it "
                            "out for as many channels as the connection has")
        _check_text(self.text, "a port")


class Spikes(Signal):
    """A port of spikes: (time in ns, channel). Arguments as Signal's."""

    kind = "spikes"


class Parameter:
    """A parameter: what a user may write in the section of a .music file, checked before the run.

    default: its value when nothing is written; left out, it must be written.
    unit: "s", "Hz", ...; the node gets the value in this unit, users may write others ("30 ms").
    minimum, maximum: bounds of a number, in its unit.
    choices: the only texts that may be written.
    type: float, int, bool or str; without it, the default's, where 100 is a float like 100.0.
    text: one line for `spikeloop describe`, without a full stop.

    Raises NodeError when these do not fit together.
    """

    def __init__(self, default=_REQUIRED, *, unit="", minimum=None, maximum=None, choices=None,
                 type=None, text=""):
        self.required = default is _REQUIRED
        self.unit, self.text = _with_ascii_micro(unit), text
        self.minimum = -math.inf if minimum is None else minimum
        self.maximum = math.inf if maximum is None else maximum
        self.choices = list(choices or ())
        self.kind = self._kind(default, type)
        self._check_declaration()
        self.default = None if self.required else self.value(default, "the default")

    def _kind(self, default, type):
        if self.choices:
            return "choice"
        if type is None:
            type = next((each for each in (bool, int, float, str) if isinstance(default, each)),
                        float if self.required else default.__class__)
            type = float if type is int else type
        if type not in _TYPES:
            raise NodeError(f"a parameter of type {getattr(type, '__name__', type)}; write a "
                            "number, a text, True or False, or spikeloop.Weights for a table")
        return _TYPES[type]

    def _check_declaration(self):
        numeric = self.kind in ("number", "integer")
        if self.unit not in UNITS:
            raise NodeError(f"there is no unit '{self.unit}'; write one of: {', '.join(UNITS[1:])}")
        if not numeric and (self.unit or self.minimum != -math.inf or self.maximum != math.inf):
            raise NodeError(f"a parameter that is a {self.kind} has no unit and no bounds; write "
                            "its default as a number in its unit, such as 0.03 for 30 ms")
        if not self.minimum <= self.maximum:
            raise NodeError(f"minimum={self.minimum} is not below maximum={self.maximum}; exchange "
                            "them")
        for choice in self.choices:
            if not isinstance(choice, str) or not choice or "|" in choice:
                raise NodeError(f"a choice is {choice!r}; write texts without '|'")
        _check_text(self.text, "a parameter")

    def value(self, given, what):
        """The checked value of this parameter's type; `what` names it in an error."""
        if self.kind in ("text", "choice"):
            if not isinstance(given, str) or "\n" in given:
                raise NodeError(f"{what} is {given!r}; write one line of text")
            if self.choices and given not in self.choices:
                raise NodeError(f"{what} is '{given}'; write one of: {', '.join(self.choices)}")
            return given
        if self.kind == "boolean":
            if not isinstance(given, bool):
                raise NodeError(f"{what} is {given!r}; write True or False")
            return given
        return self._number(given, what)

    def _number(self, given, what):
        whole = self.kind == "integer"
        try:
            number = int(given) if whole else float(given)
        except (TypeError, ValueError, OverflowError):
            number = None
        if number is None or isinstance(given, (str, bool)) or (whole and number != given) \
                or not math.isfinite(number):
            raise NodeError(f"{what} is {given!r}; write a {'whole' if whole else 'finite'} number")
        if not self.minimum <= number <= self.maximum:
            raise NodeError(f"{what} is {given}, which is out of bounds; write a number from "
                            f"{self.minimum} to {self.maximum}")
        return number

    def default_text(self):
        """As one would write it in a .music file; None when it must be given."""
        if self.required:
            return None
        if self.kind == "boolean":
            return "true" if self.default else "false"
        if self.kind == "number" and self.default == int(self.default) and abs(self.default) < 1e15:
            return str(int(self.default))
        return str(self.default)

    def plain(self, name):
        """As the libraries take it: parameter_of() of python/values."""
        return (name, self.kind, self.unit, self.default_text(), float(self.minimum),
                float(self.maximum), self.choices, self.text)


class Weights(Parameter):
    """A parameter that is a table: `weights=readout.json`. The node gets a float64 array with a row
    an output and a column an input.

    default: a short form: "uniform" (1 / inputs), "uniform:0.01", "one_to_one", "one_to_one:2";
    left out, it must be written. text: one line.
    """

    def __init__(self, default=_REQUIRED, *, text=""):
        super().__init__(default, type=str, text=text)
        self.kind = "weights"

    def value(self, given, what):
        return given


def script_parameter(name, value):
    """The Parameter of a script or of a network's function: `value`, or one with this default.

    Raises NodeError for a table.
    """
    try:
        parameter = value if isinstance(value, Parameter) else Parameter(value)
    except NodeError as error:
        raise NodeError(f"'{name}': {error}") from None
    if isinstance(parameter, Weights):
        raise NodeError(f"parameter '{name}' is a table; take its file's name, as "
                        f"{name}=spikeloop.Parameter(type=str), and read it with numpy.load")
    return parameter


class Definition:
    """A node class: `name`, `text`, `ports` and `parameters` by name, and how to make one."""

    def __init__(self, target, name, inputs, outputs, parameters, line):
        self.target = target
        self.name = name or _snake_case(target.__name__)
        self.text = ((target.__doc__ or "").strip().splitlines() or [""])[0].rstrip(" .")
        self.module, self.line = target.__module__, line
        if not re.fullmatch(r"[a-z][a-z0-9_]*", self.name):
            raise NodeError(f"'{self.name}' is not a name for a node; write one such as my_encoder "
                            "with @spikeloop.node(name=...)")
        self.inputs = _ports(inputs, "inputs", self.name)
        self.outputs = _ports(outputs, "outputs", self.name)
        self.parameters = parameters
        self._check_ports()

    @property
    def ports(self):
        """All by name: inputs, then outputs."""
        return {**self.inputs, **self.outputs}

    def _check_ports(self):
        twice = sorted(set(self.inputs) & set(self.outputs))
        if twice:
            raise NodeError(f"node '{self.name}': an input and an output are both named "
                            f"'{twice[0]}'; give one another name")
        ports = self.ports
        if not ports:
            raise NodeError(f"node '{self.name}' has no port; write for example "
                            'inputs = {"in": spikeloop.Signal()}')
        for name, port in ports.items():
            seen = {name}
            while port.same_as is not None:
                if port.same_as not in ports:
                    raise NodeError(f"node '{self.name}': port '{name}' is as wide as "
                                    f"'{port.same_as}', which is not a port of it"
                                    f"{did_you_mean(port.same_as, sorted(ports))}")
                if port.same_as in seen:
                    raise NodeError(f"node '{self.name}': same_as leads from port '{name}' back to "
                                    f"'{port.same_as}'; leave it out of one of them")
                seen.add(port.same_as)
                port = ports[port.same_as]

    def make(self, setup):
        """A node: (its step, its counters or None). Its parameters are set before __init__ runs."""
        if not inspect.isclass(self.target):
            return functools.partial(self.target, **setup.parameters), None
        made = self.target.__new__(self.target)
        for name, value in setup.parameters.items():
            setattr(made, name, value)
        if self.target.__init__ is not object.__init__:
            alone = len(inspect.signature(self.target.__init__).parameters) == 1
            made.__init__(*(() if alone else (setup,)))
        return made.step, getattr(made, "counters", None)


defined = []  # every Definition, in the order of the files


def node(target=None, /, *, name=None, inputs=None, outputs=None, **parameters):
    """Declares a class or a function a node; gives it back unchanged.

    A class needs nothing else: its attributes are the declaration. A function gets its ports here,
    as Signal(), Spikes() or just "signal", "spikes"; further arguments are its parameters, as
    Parameter(...) or just a default. The node is called as the class or function is, in snake_case,
    unless `name` is given. The first line of the docstring describes it.

    Raises NodeError when the declaration does not fit together.
    """
    line = sys._getframe(1).f_lineno  # of the decorator

    def declare(what):
        make = _class_definition if inspect.isclass(what) else _function_definition
        definition = make(what, name, inputs, outputs, parameters, line)
        what.__spikeloop__ = definition
        defined.append(definition)
        return what

    return declare if target is None else declare(target)


def definition_of(target):
    """The Definition of a decorated class or function.

    Raises NodeError when it is not decorated (a class that inherits from a decorated one is not).
    """
    found = vars(target).get("__spikeloop__") if hasattr(target, "__dict__") else None
    if found is None:
        raise NodeError(f"{getattr(target, '__name__', target)!r} is not a node; write "
                        "@spikeloop.node before it")
    return found


def _class_definition(target, name, inputs, outputs, parameters, line):
    given = [key for key, value in (("inputs", inputs), ("outputs", outputs)) if value is not None]
    if given or parameters:
        raise NodeError(f"class {target.__name__}: '{(given + list(parameters))[0]}' stands in "
                        "@spikeloop.node(...); write it as an attribute of the class")
    if not callable(getattr(target, "step", None)):
        raise NodeError(f"class {target.__name__} has no step; write  def step(self, step): ...")
    found = {}
    for each in reversed(target.__mro__):
        for key, value in vars(each).items():
            if isinstance(value, Parameter):
                found[key] = value
    return Definition(target, name, getattr(target, "inputs", {}), getattr(target, "outputs", {}),
                      found, line)


def _function_definition(target, name, inputs, outputs, parameters, line):
    if not callable(target):
        raise NodeError(f"@spikeloop.node stands before {target!r}; write it before a class or a "
                        "function")
    declared = {key: value if isinstance(value, Parameter) else Parameter(value)
                for key, value in parameters.items()}
    expected = ["step", *declared]
    taken = inspect.signature(target).parameters
    if list(taken)[:1] != ["step"] or set(taken) != set(expected):
        raise NodeError(f"{target.__name__}() takes ({', '.join(taken)}), but its node has "
                        f"({', '.join(expected)}); write  def {target.__name__}"
                        f"({', '.join(expected)}):")
    return Definition(target, name, inputs or {}, outputs or {}, declared, line)


def _ports(declared, what, node_name):
    if not isinstance(declared, dict):
        raise NodeError(f"node '{node_name}': {what} is {declared!r}; write a dict such as "
                        '{"in": spikeloop.Signal()}')
    ports = {}
    for name, port in declared.items():
        if not isinstance(name, str) or not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name):
            raise NodeError(f"node '{node_name}': {name!r} is not a name for a port; write letters, "
                            "digits and _, such as 'in'")
        port = {"signal": Signal(), "spikes": Spikes()}.get(port, port) \
            if isinstance(port, str) else port
        if not isinstance(port, Signal):
            raise NodeError(f"node '{node_name}': port '{name}' is {port!r}; write "
                            "spikeloop.Signal() or spikeloop.Spikes()")
        ports[name] = port
    return ports


def _snake_case(name):
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()


def _check_text(text, what):
    if not isinstance(text, str) or "\n" in text:
        raise NodeError(f"the text of {what} is {text!r}; write one line")
