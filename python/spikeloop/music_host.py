"""A script in Python as a MUSIC program: whatever simulates neurons can take part in a job.

    import spikeloop

    with spikeloop.music(spikes_in={"in": 100}, spikes_out={"out": 100}) as host:
        for tick in host:                          # until the end of the run
            times, channels = tick.spikes("in")    # of (tick.begin_s, tick.end_s]
            tick.send("out", times, channels)

The script is the section's `binary`; docs/simulators.md has the rules.
"""

import atexit
import collections
import os
import sys

import numpy as np

from .declare import NodeError, did_you_mean, script_parameter
from .music_library import library
from .node_host import report

Spikes = collections.namedtuple("Spikes", "times channels")
Spikes.__doc__ = """Sorted by (time, channel): float64 seconds, int32 channels from 0."""

EXIT_USAGE = 2
EXIT_SCRIPT = 5  # as of a node that failed
EXIT_INTERRUPT = 130


class HostError(NodeError):
    """What a script did with its host is wrong; the text says what, and what to write."""


class Tick:
    """The interval (begin_s, end_s] of simulated time, and the ports. Good until the next one.

    begin_ns, end_ns: the same in whole nanoseconds.
    """

    def __init__(self, host, begin_ns, end_ns):
        self.begin_ns, self.end_ns = begin_ns, end_ns
        self.begin_s, self.end_s = begin_ns / 1e9, end_ns / 1e9
        self._host = host

    def spikes(self, port):
        """(times, channels) of a spike input: seconds, exact to the nanosecond. Late ones
        (time <= begin_s) stand first."""
        times, channels = self._library().spikes(self._index(port, "spikes", True))
        return Spikes(times / 1e9, channels)

    def send(self, port, times, channels):
        """Sends spikes, in any order: seconds, begin_s < time <= end_s, rounded to nanoseconds, and
        channels from 0. Arrays or lists of equal length, or one number for all of them."""
        i = self._index(port, "spikes", False)
        times, channels = self._pairs(port, times, channels)
        stamps = np.rint(times * 1e9)
        if not np.all((stamps > self.begin_ns) & (stamps <= self.end_ns)):
            self._refuse_time(port, times[~((stamps > self.begin_ns) & (stamps <= self.end_ns))][0])
        width = self._host.widths[port]
        if channels.size and not 0 <= channels.min() <= channels.max() < width:
            wrong = channels[(channels < 0) | (channels >= width)][0]
            raise HostError(f"tick.send('{port}', ...) got channel {wrong}, but the port has "
                            f"channels 0 to {width - 1}")
        self._library().send(i, stamps.astype(np.int64), channels.astype(np.int32))

    def signal(self, port):
        """The values of a continuous input, float64, one a channel; None while there is none yet."""
        values, revision = self._library().signal(self._index(port, "signal", True))
        return values if revision else None

    def write(self, port, values):
        """Sets a continuous output: as many numbers as it has channels, or one for all of them. It
        holds until it is written again."""
        i = self._index(port, "signal", False)
        width = self._host.widths[port]
        given = np.asarray(values)
        if given.dtype.kind not in "fiub" or given.ndim and given.shape != (width,):
            raise HostError(f"tick.write('{port}', ...) got {_text_of(given)}, but the port has "
                            f"{width} channels; write {width} numbers, or one for all of them")
        self._library().write(i, np.broadcast_to(given, width).astype(float))

    def _pairs(self, port, times, channels):
        times, channels = np.asarray(times), np.asarray(channels)
        for what, given, kinds in (("times", times, "fiu"), ("channels", channels, "iu")):
            if given.size and given.dtype.kind not in kinds or given.ndim > 1:
                raise HostError(f"tick.send('{port}', ...) got {what} that are {_text_of(given)}; "
                                "write times in seconds and whole channels, one a spike")
        if times.ndim and channels.ndim and times.size != channels.size:
            raise HostError(f"tick.send('{port}', ...) got {times.size} times and {channels.size} "
                            "channels; write as many times as channels")
        times, channels = np.broadcast_arrays(times, channels)
        return np.atleast_1d(times).astype(float), np.atleast_1d(channels)

    def _refuse_time(self, port, wrong):
        if not np.isfinite(wrong):
            raise HostError(f"tick.send('{port}', ...) got the time {wrong}; write seconds")
        raise HostError(f"tick.send('{port}', ...) got a spike at {wrong:.12g} s, outside of the "
                        f"interval ({self.begin_s:.12g}, {self.end_s:.12g}] s; write times after "
                        "tick.begin_s, and up to tick.end_s")

    def _library(self):
        if self._host is None:
            raise HostError("the tick is over; use it inside its turn of the loop only")
        return self._host._library

    def _index(self, port, kind, is_input):
        self._library()
        try:
            return self._host._ports[kind, is_input][port]
        except (KeyError, TypeError):
            pass
        call = {"spikes": "tick.spikes" if is_input else "tick.send",
                "signal": "tick.signal" if is_input else "tick.write"}[kind]
        known = list(self._host._ports[kind, is_input])
        argument = {("spikes", True): "spikes_in", ("spikes", False): "spikes_out",
                    ("signal", True): "signals_in", ("signal", False): "signals_out"}
        raise HostError(f"{call}('{port}'): {argument[kind, is_input]} of spikeloop.music has no "
                        f"'{port}'{did_you_mean(port, known)}") from None

    def _close(self):
        self._host = None


class Host:
    """What spikeloop.music gives.

    label: of the section. tick_s, duration_s: seconds; a duration of None is a run until it is
    stopped. seed: the key `seed`. parameters: values by name. widths: number of channels by port.
    directory: where the .music file, or the experiment file, lies.
    """

    _tick_type = Tick
    _many_processes = False  # np above 1

    def __init__(self, *, spikes_in=None, spikes_out=None, signals_in=None, signals_out=None,
                 **parameters):
        _refuse_unknown_ports(parameters)
        ports = _declared_ports({("spikes", True): spikes_in, ("spikes", False): spikes_out,
                                 ("signal", True): signals_in, ("signal", False): signals_out})
        declared = [script_parameter(name, value).plain(name) for name, value in parameters.items()]
        self._begun = self._complete = self._finished = False
        self._end = End.begin()
        self.label = self._end.label
        with self._end.fatal():
            self._library = library().Host(list(sys.argv), ports, declared, self._many_processes)
        self._end.host = self._library
        sys.argv[1:] = self._library.arguments()
        self.widths = {port[0]: width for port, width in zip(ports, self._library.widths())}
        self._ports = collections.defaultdict(dict)
        for name, kind, is_input, _ in ports:
            self._ports[kind, is_input][name] = len(self._ports[kind, is_input])
        self.parameters = self._library.parameters()
        self.directory = self._library.directory()
        self.seed = self._library.seed()
        self._tick_ns, self._stop_ns = self._library.tick(), self._library.stoptime()
        self.tick_s = self._tick_ns / 1e9
        self.duration_s = None if self._stop_ns is None else self._stop_ns / 1e9

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if error is not None and not (isinstance(error, SystemExit) and not error.code):
            self._end.fail(error, trace)
        if not self._begun:
            self._end.stop(EXIT_SCRIPT, "the script has left `with spikeloop.music(...)` without "
                           "its loop; write  for tick in host: ...")
        self._finish()

    def __iter__(self):
        """Ticks until `stoptime`, or until the job is stopped. Before the first one the programs of
        the job meet: what takes long belongs before the loop."""
        if self._begun:
            raise HostError("the loop has been begun before; write one  for tick in host: ...")
        self._begun = True
        while True:
            with self._end.fatal():
                interval = self._library.begin()
            if interval is None:
                self._complete = True
                break
            tick = self._tick_type(self, *interval)
            self._at_s = tick.begin_s
            yield tick
            tick._close()
            with self._end.fatal():
                self._library.end()
        self._finish()

    def _finish(self):
        if not self._finished:
            if not self._complete and self._library.processes() > 1:
                self._end.stop(EXIT_SCRIPT, f"one of its {self._library.processes()} processes has "
                               f"left the loop at {self._at_s:g} s of simulated time, and the others "
                               "wait for it; leave no loop before its end")
            self._finished = True
            with self._end.fatal():
                self._library.finish()
            self._end.active = False


class End:
    """However the script ends, the job must not hang: what is not the end of the loop ends the job,
    with the reason."""

    current = None

    @classmethod
    def begin(cls):
        """For a host. Raises HostError for a second one; ends a script that MUSIC has not
        started."""
        end = cls.current or cls.take_over()
        if end.has_host:
            raise HostError("spikeloop.music has been called before; a script has one host")
        end.has_host = True
        return end

    @classmethod
    def take_over(cls):
        """From now on; before MUSIC's Setup. Ends a script that MUSIC has not started."""
        if not library().started_by_music(sys.argv):
            name = sys.argv[0] if "/" in sys.argv[0] else "./" + sys.argv[0]
            print(f"{name}: is started by MUSIC; write a section with binary={name} and np=1 into "
                  "FILE.music and run  spikeloop run FILE.music", file=sys.stderr)
            raise SystemExit(EXIT_USAGE)
        cls.current = end = cls()
        sys.excepthook, end.hook = end.uncaught, sys.excepthook
        atexit.register(end.leaving)
        end.label = library().take_signals(list(sys.argv))
        end.active = True
        return end

    def __init__(self):
        self.label, self.active, self.has_host = "", False, False
        self.hook = self.host = None

    def uncaught(self, kind, error, trace):
        if self.active:
            self.leave(lambda: self.fail(error, trace))
        self.hook(kind, error, trace)

    def leaving(self):
        if self.active:
            self.leave(lambda: self.stop(
                EXIT_SCRIPT, "the script has ended without its loop; write  with "
                "spikeloop.music(...) as host:  and in it  for tick in host: ..."))

    @staticmethod
    def leave(stop):
        """Python does not listen to sys.exit() any more."""
        try:
            stop()
        except SystemExit as left:
            os._exit(left.code)

    def fatal(self):
        return _Fatal(self)

    def fail(self, error, trace):
        """Ends the job because of an exception: its traceback, and the last line says what and
        where."""
        if isinstance(error, KeyboardInterrupt):
            self.stop(EXIT_INTERRUPT, "stopped by Ctrl-C")
        if isinstance(error, library().SectionError):
            self.stop(error.exit_code, str(error))
        if isinstance(error, SystemExit):
            code = error.code if isinstance(error.code, int) else 1
            said = "" if isinstance(error.code, int) else f": {error.code}"
            self.stop(min(max(code, 1), 255), f"the script has ended itself by sys.exit{said}")
        message, lines = report(error, trace)
        self.wait_for_the_first()
        for line in lines:
            print(f"{self.label}: {line}", file=sys.stderr)
        self.stop(EXIT_SCRIPT, message)

    def wait_for_the_first(self):
        """Of several processes all may fail alike: the first one says so, and ends the job."""
        if self.host is not None:
            self.host.let_the_first_speak()

    def stop(self, exit_code, message):
        """Does not return."""
        self.active = False
        self.wait_for_the_first()
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        library().end_job(self.label, exit_code, message)
        sys.exit(exit_code)  # MPI was not up


class _Fatal:
    """What the library throws cannot be caught by the script: MUSIC would be left half done."""

    def __init__(self, end):
        self.end = end

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if error is not None:
            self.end.fail(error, trace)


def music(*, spikes_in=None, spikes_out=None, signals_in=None, signals_out=None, **parameters):
    """Makes this script a MUSIC program; gives its Host. Once a script.

    spikes_in, spikes_out, signals_in, signals_out: ports, {name: number of channels}; None stands
    for as many as the connection in the .music file has. A port with a number may stay unconnected.
    parameters: keys of the script's section, as spikeloop.Parameter(20e-3, unit="s") or just a
    default. They and Spikeloop's own keys (stoptime, music_timestep, record, ...) are checked here.

    Raises HostError for what does not fit together. What is wrong in the .music file ends the job,
    with its place.
    """
    return Host(spikes_in=spikes_in, spikes_out=spikes_out, signals_in=signals_in,
                signals_out=signals_out, **parameters)


def _refuse_unknown_ports(parameters):
    for name, value in parameters.items():
        if isinstance(value, dict):
            raise HostError(f"'{name}' is a dict, but not an argument for ports"
                            f"{did_you_mean(name, ('spikes_in', 'spikes_out', 'signals_in', 'signals_out'))}")


def _declared_ports(groups):
    ports = []
    for (kind, is_input), given in groups.items():
        for name, width in _names_and_widths(given):
            if not isinstance(name, str) or not name:
                raise HostError(f"a port is named {name!r}; write a name, such as 'in'")
            if name in (port[0] for port in ports):
                raise HostError(f"two ports are named '{name}'; give one another name")
            whole = isinstance(width, (int, np.integer)) and not isinstance(width, bool)
            if width is not None and not (whole and 1 <= width < 2**31):
                raise HostError(f"port '{name}' has the width {width!r}; write a whole number from "
                                "1, or None for as many channels as the file says")
            ports.append((name, kind, is_input, int(width or 0)))
    if not ports:
        raise HostError('a host without ports; write  spikeloop.music(spikes_in={"in": 100})')
    return ports


def _names_and_widths(given):
    if given is None:
        return ()
    if not isinstance(given, dict):
        raise HostError(f"ports are {given!r}; write a dict such as {{'in': 100}}, or {{'in': None}}"
                        " for as many channels as the file says")
    return given.items()


def _text_of(array):
    if array.dtype.kind not in "fiub":
        return f"values of type {array.dtype}"
    return f"{array.size} values of type {array.dtype}" + (
        f" in {array.ndim} dimensions" if array.ndim > 1 else "")
