"""A Python node while it runs: what it is made from, what it sees in an interval, its checks.

The programs and `spikeloop.testing` run nodes through the same Session, so that a node behaves the
same in a unit test and in a job.
"""

import collections
import gc
from sys import getrefcount

import numpy as np

from .declare import NodeError, did_you_mean

# As in C: spikeloop_spike. NumPy's fields of such an array are views, nothing is copied.
SPIKE = np.dtype([("time_ns", np.int64), ("channel", np.int32), ("reserved", np.int32)])
MOST_COUNTERS = 32

SpikeTrain = collections.namedtuple("SpikeTrain", "times_ns channels")
SpikeTrain.__doc__ = """Spikes sorted by (time, channel): int64 ns, int32 channels from 0."""


def name_hash(name):
    """FNV-1a, 64 bit, as core's: keys the random numbers of a node."""
    value = 0xCBF29CE484222325
    for byte in name.encode():
        value = (value ^ byte) * 0x100000001B3 % 2**64
    return value


class Setup:
    """What a node is made from.

    name: of its section. seed: of the run. widths: number of channels by port. parameters: values
    by name, which are attributes of the node as well.
    """

    def __init__(self, name, seed, widths, parameters):
        self.name, self.seed = name, seed
        self.widths, self.parameters = widths, parameters

    def random(self, purpose=0):
        """A numpy.random.Generator keyed by (seed, name of the node, purpose): the same numbers in
        every run, whatever else runs. purpose: a whole number that keeps apart several uses."""
        return np.random.Generator(np.random.Philox(key=[self.seed, name_hash(self.name)],
                                                    counter=[0, 0, purpose, 0]))


class _Inputs(dict):
    """Signal inputs by name."""

    def __init__(self, step):
        super().__init__()
        self.step = step

    def __missing__(self, port):
        self.step._refuse(port, "signal", "input", f"step.spikes('{port}')")


class Step:
    """The interval (begin, end] and the ports. One object for the whole run; it answers only while
    the node's step() runs, and so do the arrays it gives: they are the graph's own memory, not
    copies, inputs read-only. To keep values beyond the step, copy them: step.inputs["in"].copy().

    begin, end: whole nanoseconds.
    inputs: by name, float64 array of the port's width, or None while there is no value yet.
    """

    def __init__(self, definition, widths):
        self.begin = self.end = 0
        self.inputs = _Inputs(self)
        self._widths = widths
        self._ports = definition.ports
        order = {}
        for group in (definition.inputs, definition.outputs):
            for kind in ("signal", "spikes"):
                names = [name for name, port in group.items() if port.kind == kind]
                order[kind, group is definition.inputs] = {name: i for i, name in enumerate(names)}
        self._signals_in, self._spikes_in = order["signal", True], order["spikes", True]
        self._signals_out, self._spikes_out = order["signal", False], order["spikes", False]
        self._seen = [0] * len(self._signals_in)
        self._counts = [0] * len(self._signals_out)
        self._open = False

    @property
    def duration(self):
        """end - begin in nanoseconds."""
        return self.end - self.begin

    def width(self, port):
        """Number of channels of any port."""
        if port not in self._widths:
            raise NodeError(f"there is no port '{port}'{did_you_mean(port, list(self._widths))}")
        return self._widths[port]

    def revision(self, port):
        """Number of a signal input's value: another one whenever it was set; 0: none yet."""
        return self._revisions[self._index(self._signals_in, port, "signal", "input",
                                           "step.spikes")]

    def changed(self, port):
        """True when a signal input has a value that was set since the step before."""
        i = self._index(self._signals_in, port, "signal", "input", "step.spikes")
        return self._revisions[i] not in (0, self._seen[i])

    def spikes(self, port):
        """(times_ns, channels) of a spike input: sorted, late ones (time <= begin) first."""
        i = self._index(self._spikes_in, port, "spikes", "input", "step.inputs")
        train = self._trains[i]
        if train is None:
            spikes = self._arrived[i]
            train = self._trains[i] = SpikeTrain(spikes["time_ns"], spikes["channel"])
        return train

    def write(self, port, values):
        """Sets a signal output: as many numbers as it has channels, or one for all of them.

        It holds until it is written again. A value that is not a number (NaN) passes as one channel
        of several; in all channels it means "no value yet" to other programs.
        """
        i = self._index(self._signals_out, port, "signal", "output", "step.emit")
        given = np.asarray(values)
        out = self._outputs[i]
        if given.dtype.kind not in "fiub":
            raise NodeError(f"step.write('{port}', ...) got {_type_text(values, given)}; write "
                            "real numbers")
        if given.ndim and given.shape != out.shape:
            raise NodeError(f"step.write('{port}', ...) got {_shape_text(given)}, but the port has "
                            f"{_channels(out.size)}; write {_values(out.size)}")
        out[...] = given
        self._commit(i)

    def output(self, port):
        """The float64 array of a signal output, to fill in place; it counts as written."""
        i = self._index(self._signals_out, port, "signal", "output", "step.emit")
        self._commit(i)
        return self._outputs[i]

    def invalidate(self, port):
        """Takes a signal output back: it has no value, until it is written again."""
        self._written[self._index(self._signals_out, port, "signal", "output", "step.emit")] = -1

    def emit(self, port, times_ns, channels):
        """Sends spikes, in any order: times in whole nanoseconds, begin < time <= end, and channels
        from 0. Arrays or lists of equal length, or one number for all of them."""
        i = self._index(self._spikes_out, port, "spikes", "output", "step.write")
        times, lanes = np.asarray(times_ns), np.asarray(channels)
        if not (times.size and lanes.size):
            self._check_empty(port, times, lanes)
            return
        if times.dtype.kind != "i" or lanes.dtype.kind not in "iu":
            self._refuse_types(port, times, lanes)
        if times.ndim > 1 or lanes.ndim > 1 or (times.ndim and lanes.ndim
                                                and times.size != lanes.size):
            raise NodeError(f"step.emit('{port}', ...) got {_shape_text(times, 'time')} and "
                            f"{_shape_text(lanes, 'channel')}; write as many times as channels")
        lanes = lanes.astype(np.int64, copy=False)
        if _largest(np.subtract(times, self.begin + 1, dtype=np.int64)) >= self.end - self.begin:
            self._refuse_time(port, times)
        if _largest(lanes) >= self._widths[port]:
            self._refuse_channel(port, lanes)
        spikes = np.zeros(max(times.size, lanes.size), SPIKE)
        spikes["time_ns"] = times
        spikes["channel"] = lanes
        self._emitted[i].append(spikes)

    def _index(self, ports, name, kind, direction, other):
        try:
            if self._open:
                return ports[name]
        except (KeyError, TypeError):
            self._refuse(name, kind, direction, f"{other}")
        raise NodeError("the step is over; use it inside the node's step() only")

    def _refuse(self, name, kind, direction, other):
        names = {("signal", "input"): self._signals_in, ("spikes", "input"): self._spikes_in,
                 ("signal", "output"): self._signals_out, ("spikes", "output"): self._spikes_out}
        wrong_kind = names["spikes" if kind == "signal" else "signal", direction]
        if not self._open:
            raise NodeError("the step is over; use it inside the node's step() only") from None
        what = {"signal": f"signal {direction}", "spikes": f"{direction} of spikes"}
        if name in wrong_kind:
            kinds = ("spikes", "a signal") if kind == "signal" else ("a signal", "spikes")
            raise NodeError(f"'{name}' carries {kinds[0]}, not {kinds[1]}; use "
                            f"{other.split('(')[0]}") from None
        raise NodeError(f"there is no {what[kind]} '{name}'"
                        f"{did_you_mean(name, list(names[kind, direction]))}") from None

    @staticmethod
    def _check_empty(port, times, lanes):
        if times.size > 1 or lanes.size > 1:
            raise NodeError(f"step.emit('{port}', ...) got {_shape_text(times, 'time')} and "
                            f"{_shape_text(lanes, 'channel')}; write as many times as channels")

    @staticmethod
    def _refuse_types(port, times, lanes):
        if times.dtype.kind != "i":
            raise NodeError(f"step.emit('{port}', ...) got times that are {times.dtype}; write "
                            "whole nanoseconds: np.rint(seconds * 1e9).astype(np.int64)")
        raise NodeError(f"step.emit('{port}', ...) got channels that are {lanes.dtype}; write "
                        "whole numbers from 0: channels.astype(np.int32), np.flatnonzero(mask)")

    def _refuse_time(self, port, times):
        times = np.atleast_1d(times)
        wrong = times[(times <= self.begin) | (times > self.end)][0]
        raise NodeError(f"step.emit('{port}', ...) got a spike at {wrong} ns, outside of the "
                        f"interval ({self.begin}, {self.end}] ns; write times after step.begin, and "
                        "up to step.end")

    def _refuse_channel(self, port, lanes):
        width, lanes = self._widths[port], np.atleast_1d(lanes)
        wrong = lanes[(lanes < 0) | (lanes >= width)][0]
        raise NodeError(f"step.emit('{port}', ...) got channel {wrong}, but the port has channels "
                        f"0 to {width - 1}")

    def _commit(self, i):
        if self._written[i] <= 0:  # a revision is never used twice, not after invalidate() either
            self._counts[i] += 1
            self._written[i] = self._counts[i]

    def _enter(self, begin, end, values, revisions, arrived, outputs):
        self.begin, self.end = begin, end
        self._revisions, self._arrived, self._outputs = revisions, arrived, outputs
        for name, i in self._signals_in.items():
            self.inputs[name] = values[i] if revisions[i] else None
        self._trains = [None] * len(arrived)
        self._written = [0] * len(outputs)
        self._emitted = [[] for _ in self._spikes_out]
        self._open = True

    def _leave(self):
        self._open = False
        self._seen = list(self._revisions)
        self._arrived = self._outputs = self._trains = None
        self.inputs.clear()


class Session:
    """A node that was made: its step is called interval after interval.

    widths: by port. parameters: checked values by name.
    """

    def __init__(self, definition, name, seed, widths, parameters):
        self._view = Step(definition, widths)
        self._definition = definition
        self._step, self._counters = definition.make(Setup(name, seed, widths, parameters))

    def advance(self, begin, end, values, revisions, arrived, outputs):
        """Calls the node's step.

        values, revisions: of the signal inputs, in order. arrived: SPIKE arrays of the spike
        inputs. outputs: arrays of the signal outputs. Gives (written, emitted): for every signal
        output its new revision, 0 for unchanged, -1 for invalid; for every spike output a list of
        SPIKE arrays.
        """
        view = self._view
        before = [getrefcount(array) for array in values + arrived + outputs]
        view._enter(begin, end, values, revisions, arrived, outputs)
        try:
            result = self._step(view)
        finally:
            view._leave()
        if result is not None:
            raise NodeError(f"step() gave back {_type_text(result)}; write step.write(PORT, "
                            "values) or step.emit(PORT, times_ns, channels), and return nothing")
        if before != [getrefcount(array) for array in values + arrived + outputs]:
            self._refuse_kept(values, arrived, outputs, before)
        return view._written, view._emitted

    def counters(self):
        """[(name, count), ...] of the node's counters()."""
        given = {} if self._counters is None else self._counters()
        if not isinstance(given, dict) or len(given) > MOST_COUNTERS:
            what = f"{len(given)} entries" if isinstance(given, dict) else _type_text(given)
            raise NodeError(f"counters() gave back {what}; write a dict of at most {MOST_COUNTERS} "
                            'counts, such as {"clipped": 3}')
        return [(_counter_name(name), _count(name, value)) for name, value in given.items()]

    def _refuse_kept(self, values, arrived, outputs, before):
        # A cycle of references that nobody uses any more is not kept, just not yet collected.
        gc.collect()
        after = [getrefcount(array) for array in values + arrived + outputs]
        names = [*self._view._signals_in, *self._view._spikes_in, *self._view._signals_out]
        for name, earlier, later in zip(names, before, after):
            if later > earlier:
                raise NodeError(f"the node keeps the array of port '{name}' beyond its step; its "
                                "memory is the graph's and changes: keep a copy, .copy()")


def _counter_name(name):
    if not isinstance(name, str) or not name.isidentifier():
        raise NodeError(f"counters() has the name {name!r}; write letters, digits and _")
    return name


def _count(name, value):
    try:
        count = int(value)
    except (TypeError, ValueError, OverflowError):
        count = -1
    if count != value or not 0 <= count < 2**64:
        raise NodeError(f"counters(): '{name}' is {value!r}; write a whole number from 0")
    return count


def _largest(numbers):
    """Of int64, seen as unsigned: what is below 0 is very large, one comparison for two bounds."""
    return np.maximum.reduce(numbers.view(np.uint64)) if numbers.ndim else int(numbers) % 2**64


def _channels(count):
    return f"{count} channel{'' if count == 1 else 's'}"


def _values(count):
    return f"{count} value{'' if count == 1 else 's'}"


def _type_text(value, array=None):
    if array is not None and array.dtype.kind != "O":
        return f"values of type {array.dtype}"
    name = type(value).__name__
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}" if value is not None else "None"


def _shape_text(array, what="value"):
    if array.ndim > 1:
        return f"{what}s of the shape {' x '.join(map(str, array.shape))}"
    return f"{array.size} {what}{'' if array.size == 1 else 's'}"
