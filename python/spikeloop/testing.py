"""Runs a Python node without the C++ programs: for unit tests, and to try one out.

    from spikeloop.testing import run_node
    run = run_node(MyRateEncoder, {"in": [[1.0], [0.0]]}, period=50_000_000, rate_max=100)
    run.spikes("out").times_ns          # array([10000000, 20000000, ...])

or step by step:

    node = NodeRunner(MyRateEncoder, widths={"in": 2}, rate_max=300)
    node.set("in", [1.0, 0.0])
    node.run_until(100_000_000, tick=10_000_000)
    node.spikes("out"), node.counters()

Times are whole nanoseconds; the tick is 1 ms unless given. The node's checks are those of a job.
"""

import numpy as np

from .declare import NodeError, SECOND, did_you_mean, definition_of
from .steps import SPIKE, Session, SpikeTrain

TICK = SECOND // 1000


class NodeRunner:
    """One node, a class or function with @spikeloop.node, and the ports around it.

    widths: by port, for ports of any width. name, seed: what random numbers are keyed by.
    parameters: by name; those left out have their defaults. A table is an array, outputs x inputs.
    Raises NodeError, as do all of its methods.
    """

    def __init__(self, node, widths=None, *, name="node", seed=1, **parameters):
        self._definition = definition = definition_of(node)
        self._widths = _settled_widths(definition, dict(widths or {}))
        self._session = Session(definition, name, seed, dict(self._widths),
                                _checked(definition, parameters))
        self._values = {port: np.zeros(self._widths[port]) for port in self._names("signal")}
        self._revisions = dict.fromkeys(self._values, 0)
        self._arriving = {port: [] for port in self._names("spikes", "inputs")}
        self._emitted = {port: [] for port in self._names("spikes", "outputs")}
        self.time = 0

    def set(self, port, values):
        """A new value of a signal input, which holds from now on; None takes it back."""
        self._known(port, "signal", "inputs")
        if values is None:
            self._revisions[port] = 0
            return
        values = np.asarray(values, dtype=float)
        if values.ndim and values.shape != (self._widths[port],):
            raise NodeError(f"input '{port}' got {values.size} values; write {self._widths[port]}")
        self._values[port][...] = values
        self._revisions[port] += 1

    def send(self, port, times_ns, channels):
        """Spikes that arrive in the next step."""
        self._known(port, "spikes", "inputs")
        times, channels = np.broadcast_arrays(times_ns, channels)
        spikes = np.zeros(times.size, SPIKE)
        spikes["time_ns"], spikes["channel"] = times.ravel(), channels.ravel()
        self._arriving[port].append(spikes)

    def step(self, tick=TICK):
        """Advances by one interval."""
        begin, self.time = self.time, self.time + tick
        inputs = list(self._names("signal", "inputs"))
        outputs = list(self._names("signal", "outputs"))
        # Not the arrays themselves: a job's are read-only, and gone after the step.
        values = [_read_only(self._values[port]) for port in inputs]
        arrived = [_read_only(_sorted(spikes)) for spikes in self._arriving.values()]
        written, emitted = self._session.advance(
            begin, self.time, values, [self._revisions[port] for port in inputs], arrived,
            [self._values[port][:] for port in outputs])
        for port, revision in zip(outputs, written):
            if revision:
                self._revisions[port] = max(revision, 0)
        for port, spikes in zip(self._emitted, emitted):
            self._emitted[port] += spikes
        for spikes in self._arriving.values():
            spikes.clear()

    def run_until(self, time, tick=TICK):
        """Steps until the clock shows `time`."""
        while self.time < time:
            self.step(min(tick, time - self.time))

    def spikes(self, port):
        """(times_ns, channels) of all spikes so far, sorted."""
        self._known(port, "spikes", "outputs")
        spikes = _sorted(self._emitted[port])
        return SpikeTrain(spikes["time_ns"], spikes["channel"])

    def values(self, port):
        """A copy of a signal output; None while it has no value."""
        self._known(port, "signal", "outputs")
        return self._values[port].copy() if self._revisions[port] else None

    def counters(self):
        """The node's counts by name."""
        return dict(self._session.counters())

    def _names(self, kind, group="ports"):
        return [name for name, port in getattr(self._definition, group).items()
                if port.kind == kind]

    def _known(self, port, kind, group):
        names = self._names(kind, group)
        if port not in names:
            what = {"signal": "signal", "spikes": "port of spikes"}[kind]
            raise NodeError(f"there is no {what} '{port}' among the {group}"
                            f"{did_you_mean(port, names)}")


def run_node(node, inputs=None, *, period=TICK, tick=None, until=None, widths=None, name="node",
             seed=1, **parameters):
    """Runs a node over a sampled signal; gives its NodeRunner.

    inputs: by port, rows x channels; row i holds from i * period on. tick: of the node; without it,
    `period`. until: the end; without it, that of the longest input.
    """
    rows = {port: np.atleast_2d(np.asarray(values, dtype=float))
            for port, values in (inputs or {}).items()}
    given = {port: values.shape[1] for port, values in rows.items()}
    runner = NodeRunner(node, {**given, **(widths or {})}, name=name, seed=seed, **parameters)
    end = until if until is not None else period * max(map(len, rows.values()), default=0)
    for row in range(-(-end // period)):
        for port, values in rows.items():
            if row < len(values):
                runner.set(port, values[row])
        runner.run_until(min(end, (row + 1) * period), tick or period)
    return runner


def _read_only(array):
    array.flags.writeable, view = True, array[:]
    view.flags.writeable = False
    return view


def _sorted(parts):
    spikes = np.concatenate(parts) if parts else np.zeros(0, SPIKE)
    return spikes[np.lexsort((spikes["channel"], spikes["time_ns"]))]


def _settled_widths(definition, widths):
    unknown = [port for port in widths if port not in definition.ports]
    if unknown:
        raise NodeError(f"there is no port '{unknown[0]}'"
                        f"{did_you_mean(unknown[0], list(definition.ports))}")
    for name, port in definition.ports.items():
        seen = port
        while seen.same_as is not None:
            name_of_other, seen = seen.same_as, definition.ports[seen.same_as]
            if seen.same_as is None and seen.width is None and name_of_other in widths:
                widths.setdefault(name, widths[name_of_other])
        widths.setdefault(name, seen.width)
        if widths[name] is None:
            raise NodeError(f"how wide is '{name}'? write widths={{'{name}': 1}}")
        if seen.width is not None and widths[name] != seen.width:
            raise NodeError(f"port '{name}' has {seen.width} channels, not {widths[name]}")
    for name, port in definition.ports.items():
        if port.same_as is not None and widths[name] != widths[port.same_as]:
            raise NodeError(f"port '{name}' is as wide as '{port.same_as}', which has "
                            f"{widths[port.same_as]} channels, not {widths[name]}")
    return widths


def _checked(definition, given):
    unknown = [name for name in given if name not in definition.parameters]
    if unknown:
        raise NodeError(f"there is no parameter '{unknown[0]}'"
                        f"{did_you_mean(unknown[0], list(definition.parameters))}")
    checked = {}
    for name, parameter in definition.parameters.items():
        if name not in given and parameter.required:
            raise NodeError(f"parameter '{name}' is missing; write {name}=...")
        checked[name] = parameter.value(given[name], f"parameter '{name}'") if name in given \
            else parameter.default
    return checked
