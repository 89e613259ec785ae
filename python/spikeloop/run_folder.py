"""Reads a run folder: recordings, the robot's trajectory, its world, the summary.

    >>> run = RunFolder("runs/2024-05-01")
    >>> scan = run.signal("sensor")        # values: rows x channels, a row holds until the next
    >>> spikes = run.spikes("network")     # list of streams: times in s, 0-based channels

Files (docs/run-folder.md):

    LABEL.h5        spikes and signals of the process LABEL
    episodes.csv    episode, begin_s, end_s, steps, return, success (1 or 0), end
    trajectory.csv  t_s, x_m, y_m, theta_rad, v_m_s, w_rad_s, collisions (counted so far)
    world.json      the robot's arena, obstacles, lamps, goals and lanes
    summary.json    results of the run
    messages.mcap   messages of sensors and commands
    resolved.json   an experiment with every default
"""

import collections
import csv
import dataclasses
import difflib
import json
import os
import pathlib
import re

import h5py
import numpy as np

NEWEST_FORMAT = 1
TRAJECTORY_COLUMNS = ("t_s", "x_m", "y_m", "theta_rad", "v_m_s", "w_rad_s", "collisions")
LARGEST = 1e9  # number of a world
MEASURED = ("data_stamp", "latency", "pace")  # signals about the loop, not in it; pace is data_stamp in older runs


class SpikeloopError(Exception):
    """What `spikeloop` refused, or why a run failed.

    code: of the error, such as "SL0202", which `spikeloop explain` describes; None when it has none.
    exit_code: of the program. messages: everything that it printed.
    """

    def __init__(self, message, exit_code=4, messages=()):
        super().__init__(message)
        found = re.search(r"\[(SL\d{4})\]$", message)
        self.code = found.group(1) if found else None
        self.exit_code = exit_code
        self.messages = list(messages)


class RunFolderError(SpikeloopError):
    """A file is missing or not what it should be; the text says which and what to do."""


def _fault_of_world(world):
    """The first thing in a world that cannot be drawn; empty if there is none."""
    def has(thing, *names):
        return isinstance(thing, dict) and all(
            isinstance(thing.get(name), (int, float)) and abs(thing[name]) <= LARGEST for name in names)

    arena, laser = world.get("arena"), world.get("laser")
    if arena is not None and not (has(arena, "min_x_m", "min_y_m", "max_x_m", "max_y_m") and
                                  arena["min_x_m"] < arena["max_x_m"] and arena["min_y_m"] < arena["max_y_m"]):
        return "arena"
    if laser is not None and not has(laser, "beams", "angle_min_rad", "angle_increment_rad"):
        return "laser"
    for kind in ("obstacles", "lanes", "goals", "lamps"):
        things = world.get(kind, [])
        for thing in things if isinstance(things, list) else [None]:
            shape = thing.get("shape") if isinstance(thing, dict) else None
            sizes = {"cylinder": ("radius_m",), "box": ("half_x_m", "half_y_m")}.get(str(shape))
            sizes = () if kind == "lamps" else sizes
            if sizes is None or not has(thing, "x_m", "y_m", *sizes) or not has({"theta_rad": 0, **thing}, "theta_rad"):
                return kind
    return ""


def require_regular(file):
    """A pipe would be waited for, and a device has no end. @raises RunFolderError"""
    if os.path.exists(file) and not os.path.isfile(file):
        raise RunFolderError(f"'{file}' cannot be read: not a regular file")


def complete_lines(file):
    """Lines of a text that a running program may write, with their ends. Ignores the last line while it is
    incomplete. @raises RunFolderError, UnicodeDecodeError"""
    require_regular(file)
    with open(file, newline="", encoding="utf-8-sig") as text:
        return [line for line in text if line.endswith("\n")]


@dataclasses.dataclass
class Spikes:
    """One recorded stream of spikes, in the order in which the loop saw them."""

    label: str  # of the process
    stream: str
    times_s: np.ndarray  # float64
    channels: np.ndarray  # int64, 0-based
    width: int
    until_s: float
    populations: list = dataclasses.field(default_factory=list)  # (name, size), in the channels' order


@dataclasses.dataclass
class Signal:
    """One recorded signal, piecewise constant: row i holds from times_s[i] to times_s[i + 1]."""

    label: str
    stream: str
    times_s: np.ndarray
    values: np.ndarray  # rows x width
    unit: str
    channels: list  # names; empty when there are none
    until_s: float
    quantities: list = dataclasses.field(default_factory=list)  # of plots: (name, unit) of each channel
    beams: tuple = None  # of plots: angle of a laser's first beam and between beams, degrees

    @property
    def width(self):
        return self.values.shape[1]

    def at(self, times_s):
        """Values at these times (n x width); NaN before the first row and after the end."""
        times_s = np.asarray(times_s, dtype=float)
        result = np.full((len(times_s), self.width), np.nan)
        row = np.searchsorted(self.times_s, times_s, side="right") - 1
        known = (row >= 0) & (times_s <= self.until_s)
        result[known] = self.values[row[known]]
        return result


def did_you_mean(word, candidates):
    near = difflib.get_close_matches(word, candidates, n=1)
    if near:
        return f"; did you mean '{near[0]}'?"
    return f"; known: {', '.join(candidates)}" if candidates else ""


def counters_of(summary):
    """Counters by name, also of an experiment whose processes have their own: {"wheels.sent": 200}; without
    those that several processes have, like `ticks`."""
    parts = [part.get("counters", {}) for part in (summary, *summary.get("processes", {}).values())]
    owners = collections.Counter(name for part in parts for name in part)
    return {name: value for part in parts for name, value in part.items() if owners[name] == 1}


class Recording:
    """What a node or process recorded: `run["encoder"].spikes.times_s`."""

    def __init__(self, run, label):
        self._run, self.label = run, label

    @property
    def spikes(self):
        """Its only stream of spikes. @raises RunFolderError: none, or several: run.spikes(label)"""
        streams = self._run.spikes(self.label)
        if len(streams) != 1:
            raise RunFolderError(f"'{self.label}' recorded {len(streams)} streams of spikes; write "
                                 f"run.spikes('{self.label}')")
        return streams[0]

    @property
    def signal(self):
        """Its signal, the widest if there are several."""
        return self._run.signal(self.label)


class RunFolder:
    """What lies in the folder of one run."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        if not os.path.isdir(path):
            raise RunFolderError(
                f"'{path}' is not a folder; name the folder that `spikeloop run --out` wrote")
        self.labels = sorted(file.stem for file in self.path.glob("*.h5"))

    def __getitem__(self, label):
        """What a node or process recorded. @raises KeyError"""
        if label not in self.labels:
            raise KeyError(f"'{label}' recorded nothing{did_you_mean(label, self.labels)}")
        return Recording(self, label)

    def counters(self):
        """Counters of the nodes by name: "encoder.spikes", "wheels.sent", ..."""
        return counters_of(self.summary())

    def neo_block(self):
        """All recordings as a Block of Neo (python3-neo): a SpikeTrain for every channel of spikes,
        an IrregularlySampledSignal for every signal."""
        import neo
        block = neo.Block(name=str(self.path))
        segment = neo.Segment()
        block.segments.append(segment)
        for label in self.labels:
            for spikes in self.spikes(label):
                for channel in range(spikes.width):
                    segment.spiketrains.append(neo.SpikeTrain(
                        np.sort(spikes.times_s[spikes.channels == channel]), units="s",
                        t_stop=spikes.until_s, name=f"{label}.{spikes.stream}[{channel}]"))
            for signal in self.signals(label):
                if len(signal.times_s) > 0:
                    segment.irregularlysampledsignals.append(neo.IrregularlySampledSignal(
                        signal.times_s, signal.values, units="dimensionless", time_units="s",
                        name=f"{label}.{signal.stream}", unit=signal.unit))
        return block

    def spikes(self, label):
        """Every spike stream of a process, sorted by name."""
        return self._read(label, "spikes", self._read_spikes)

    def signals(self, label):
        """Every signal of a process, sorted by name."""
        return self._read(label, "signals", self._read_signal)

    def signal(self, label, stream=None):
        """One signal of a process: the named one, or the widest that is not among MEASURED."""
        signals = self.signals(label)
        names = [signal.stream for signal in signals]
        if stream is not None:
            if stream not in names:
                raise RunFolderError(f"'{self._file(label)}' has no signal '{stream}'"
                                     f"{did_you_mean(stream, names)}")
            return signals[names.index(stream)]
        candidates = [signal for signal in signals if signal.stream not in MEASURED]
        if not candidates:
            raise RunFolderError(f"'{self._file(label)}' has no signal")
        return max(candidates, key=lambda signal: signal.width)

    def trajectory(self):
        """The robot's path: a dictionary of columns (TRAJECTORY_COLUMNS) as float64 arrays."""
        file = self.path / "trajectory.csv"
        if not file.exists():
            raise RunFolderError(f"'{file}' is missing: the run started no robot, and no message "
                                 "arrived on /odom")
        try:
            rows = list(csv.reader(complete_lines(file)))
        except (csv.Error, UnicodeDecodeError) as error:
            raise RunFolderError(f"'{file}' is not a table: {error}") from None
        if not rows:
            raise RunFolderError(f"'{file}' has no complete line yet: the run has just begun, or was killed")
        header = rows[0]
        absent = [name for name in TRAJECTORY_COLUMNS if name not in header]
        if absent:
            raise RunFolderError(f"'{file}' has no column '{absent[0]}'; its first line must be "
                                 f"{','.join(TRAJECTORY_COLUMNS)}")
        # A full disk may have cut a line short.
        table = np.array([row for row in rows[1:] if len(row) == len(header)],
                         dtype=object).reshape(-1, len(header))
        try:
            return {name: table[:, header.index(name)].astype(float)
                    for name in TRAJECTORY_COLUMNS}
        except ValueError as error:
            raise RunFolderError(f"'{file}' holds something that is not a number: {error}") from None

    def episodes(self):
        """The episodes that have ended: columns as arrays, `end` a list of texts."""
        file = self.path / "episodes.csv"
        if not file.exists():
            raise RunFolderError(f"'{file}' is missing: the experiment has no episodes")
        try:
            reader = csv.DictReader(complete_lines(file))
            rows = [row for row in reader if None not in row.values()]
            if not reader.fieldnames:
                raise RunFolderError(f"'{file}' has no complete line yet: the run has just begun, or was killed")
            if "episode" not in (reader.fieldnames or ()):
                raise KeyError("episode")
            table = {name: np.array([float(row[name]) for row in rows])
                     for name in ("episode", "begin_s", "end_s", "steps", "return", "success")}
            return table | {"end": [row["end"] for row in rows]}
        except (KeyError, ValueError, csv.Error) as error:
            raise RunFolderError(f"'{file}' is damaged: {error}") from None

    def messages(self, topic, fields=(), node=""):
        """The messages of a topic, such as "/scan": spikeloop.messages.Messages. Arguments as of read_messages().
        @raises RunFolderError: the run recorded none, or has no such topic (the error lists them), field or node"""
        from .messages import read_messages
        return read_messages(self._recorded_messages(), topic, fields, node)

    def topics(self):
        """Topics whose messages the run recorded: {"/scan": "sensor_msgs/LaserScan"}. @raises RunFolderError"""
        from .messages import read_topics
        return read_topics(self._recorded_messages())

    def _recorded_messages(self):
        file = self.path / "messages.mcap"
        if not file.exists():
            raise RunFolderError(f"'{file}' is missing: the run has no topics, was run with --no-record, or has its "
                                 "sensors and commands in several processes (use --layout fused)")
        return file

    def world(self):
        """The robot's world as written by the robot: arena, obstacles, lamps, goals, lanes, in metres."""
        world = self._json("world.json", "arena and obstacles are not drawn")
        if fault := _fault_of_world(world):
            raise RunFolderError(f"'{self.path / 'world.json'}' is damaged: invalid or too large value in '{fault}'; "
                                 "arena and obstacles are not drawn")
        return world

    def summary(self):
        """Results of the run: distance_m, coverage, collisions, ..."""
        return self._json("summary.json", "the run did not end by itself, or is under way")

    def resolved(self):
        """The experiment of the run with every default: nodes, connections, ..."""
        return self._json("resolved.json", "the run was not that of an experiment file")

    def _read(self, label, kind, read):
        with self._open(label) as file:
            try:
                return [read(label, name, group) for name, group in sorted(file[kind].items())]
            except (OSError, KeyError, RuntimeError, TypeError, ValueError) as error:
                raise RunFolderError(f"'{self._file(label)}' is damaged: {error}; was the run "
                                     "killed while it wrote?") from None

    def _file(self, label):
        return self.path / f"{label}.h5"

    def _json(self, name, consequence):
        file = self.path / name
        require_regular(file)
        try:
            contents = json.loads(file.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise RunFolderError(f"'{file}' is missing: {consequence}") from None
        except OSError as error:
            raise RunFolderError(f"'{file}' cannot be read: {error.strerror}") from None
        except UnicodeDecodeError as error:
            raise RunFolderError(f"'{file}' is not JSON: byte {error.start}: no UTF-8") from None
        except RecursionError:
            raise RunFolderError(f"'{file}' is nested too deeply") from None
        except json.JSONDecodeError as error:
            raise RunFolderError(f"'{file}' is not JSON: line {error.lineno}, column "
                                 f"{error.colno}: {error.msg}") from None
        if not isinstance(contents, dict):
            raise RunFolderError(f"'{file}' is not a JSON object")
        return contents

    def _open(self, label):
        file = self._file(label)
        if label not in self.labels:
            known = did_you_mean(label, self.labels)
            if (self.path / "resolved.json").exists():  # an experiment records what it can
                raise RunFolderError(f"'{self.path}' has no recording of '{label}'{known}")
            raise RunFolderError(f"'{file}' is missing: write record=true into the section '{label}'{known}")
        require_regular(file)
        try:
            opened = h5py.File(file, "r")
        except OSError as error:
            raise RunFolderError(f"'{file}' cannot be read: {error}") from None
        version = opened.attrs.get("spikeloop_format")
        if version is None or version > NEWEST_FORMAT:
            opened.close()
            raise RunFolderError(f"'{file}' is not a recording that this version can read: its "
                                 f"spikeloop_format is {version}, up to {NEWEST_FORMAT} is known")
        return opened

    @staticmethod
    def _read_spikes(label, name, group):
        count = min(len(group["timestamps_ns"]), len(group["node_ids"]))
        populations = zip(group.attrs.get("populations", []), group.attrs.get("population_sizes", []))
        return Spikes(label, name, group["timestamps_ns"][:count] * 1e-9,
                      group["node_ids"][:count].astype(np.int64), int(group.attrs["width"]),
                      group.attrs["until_ns"] * 1e-9,
                      [(str(population), int(size)) for population, size in populations])

    @staticmethod
    def _read_signal(label, name, group):
        count = min(len(group["times_ns"]), len(group["values"]))
        return Signal(label, name, group["times_ns"][:count] * 1e-9, group["values"][:count],
                      str(group["values"].attrs["unit"]),
                      [str(text) for text in group.attrs.get("channels", [])],
                      group.attrs["until_ns"] * 1e-9)
