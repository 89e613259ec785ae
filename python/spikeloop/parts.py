"""Which recorded node or process plays which part: sensor, neurons, command.

An experiment's run folder says what its nodes are (resolved.json), that of a MUSIC job which
programs ran (effective.music); names decide nothing. Everything stands in the order of the data.
Where neither file is there, names and contents decide.
"""

import dataclasses
import re

from . import quantities
from .run_folder import MEASURED, RunFolderError, require_regular

SENSORS = ("ros_sensor", "signal_playback", "ros_sensor_adapter", "ros_cont_adapter",
           "zmq_cont_adapter")
COMMANDS = ("ros_command", "ros_command_adapter", "cont_ros_adapter", "cont_zmq_adapter")


@dataclasses.dataclass
class Labels:
    """Which process plays which part; None: as the run folder says."""

    sensor: str = None
    network: str = None
    command: str = None


@dataclasses.dataclass
class Parts:
    """What a run recorded: run_folder's Signal and Spikes."""

    known: bool  # what ran
    simulated: bool = False  # latencies are those of the simulation, a number of ticks
    has_path: bool = True  # a robot of `model: FILE`, or an environment, has none
    sensors: list = dataclasses.field(default_factory=list)
    spikes: list = dataclasses.field(default_factory=list)
    signals: list = dataclasses.field(default_factory=list)  # between sensors and commands
    commands: list = dataclasses.field(default_factory=list)
    latencies: list = dataclasses.field(default_factory=list)
    notes: list = dataclasses.field(default_factory=list)  # what this run does not have
    missing: list = dataclasses.field(default_factory=list)  # what cannot be read

    def recorded(self):
        """All but the latencies."""
        return self.sensors + self.spikes + self.signals + self.commands


def find(run, labels=None):
    """The parts of a run, its sensors and commands with their quantities.

    Raises RunFolderError when resolved.json cannot be read.
    """
    resolved = run.resolved() if (run.path / "resolved.json").exists() else None
    nodes = _music_job(run) if resolved is None else _experiment(run, resolved)
    parts = Parts(known=nodes is not None, simulated=resolved is not None and _is_simulated(resolved),
                  has_path=not {"model", "environment"} & set((resolved or {}).get("robot") or {}))
    for label in _recorded(run, nodes or {}, parts):
        try:
            _add(parts, run, label, nodes[label].get("node", ""))
        except RunFolderError as error:
            parts.missing.append(str(error))
    _choose(parts, run, labels or Labels())
    if parts.known:
        _note_absence(parts, run)
    _describe(parts, run, nodes or {})
    _name_outputs(parts, resolved or {})
    return parts


def _is_simulated(resolved):
    return resolved.get("ros", "none") == "none" or resolved.get("sync") == "lockstep"


def _experiment(run, resolved):
    nodes = resolved.get("nodes")
    if not isinstance(nodes, dict):
        raise RunFolderError(f"'{run.path / 'resolved.json'}' has no 'nodes': it is not what "
                             "`spikeloop run` wrote")
    ends = [connection[end] for connection in resolved.get("connections", [])
            for end in ("from", "to")]
    return _in_order(nodes, ends)


def _music_job(run):
    """Sections by label, with the program's name as `node`; None without the file."""
    require_regular(run.path / "effective.music")
    try:
        text = (run.path / "effective.music").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    sections, label = {}, None
    for line in text.splitlines():
        if section := re.match(r"\s*\[(.+)\]\s*$", line):
            label = section[1].strip()
            sections[label] = {}
        elif label and (key := re.match(r"\s*(\w+)\s*=\s*(.+?)\s*$", line)):
            name, value = key.groups()
            sections[label].update({"node": value.rsplit("/", 1)[-1]} if name == "binary" else {name: value})
    ends = [end for arrow in re.findall(r"(\S+)\s*->\s*(\S+)", text) for end in arrow]
    return _in_order(sections, ends)


def _in_order(nodes, ends):
    """Those that connections name come first, as the data go through them."""
    names = [end.split(".")[0] for end in ends] + list(nodes)
    return {name: nodes[name] for name in dict.fromkeys(names) if name in nodes}


def _recorded(run, nodes, parts):
    if nodes and not run.labels:
        parts.notes.append("nothing is recorded: run without --no-record, a .music file with "
                           "--record")
    return [label for label in nodes if label in run.labels]


def _add(parts, run, label, kind):
    parts.spikes += run.spikes(label)
    signals = run.signals(label)
    parts.latencies += [signal for signal in signals if signal.stream == "latency"]
    signals = [signal for signal in signals if signal.stream not in MEASURED]
    if kind in SENSORS:
        parts.sensors += signals
    elif kind in COMMANDS:
        parts.commands += [signal for signal in signals if signal.stream == "command"] or signals
    else:
        parts.signals += signals


def _choose(parts, run, labels):
    """The parts that a label names; all of them where nothing says what ran."""
    for part, label, choose in (("sensors", labels.sensor, _sensor), ("spikes", labels.network, _network),
                                ("commands", labels.command, _command)):
        if label is None and parts.known:
            continue
        try:
            setattr(parts, part, choose(run, label))
        except RunFolderError as error:
            setattr(parts, part, [])
            parts.missing.append(str(error))


def _sensor(run, label):
    return [run.signal(label or _pick(run, ("sensor", "scan", "laser"), "sensor", _has_signals))]


def _command(run, label):
    return [run.signal(label or _pick(run, ("command", "motor", "wheels", "decoder"), "command", _has_signals))]


def _network(run, label):
    """Of the controlling neurons; of any process with spikes when none is a network."""
    label = label or _pick(run, ("network", "brain", "neurons", ""), "network",
                           lambda run, name: bool(run.spikes(name)))
    streams = run.spikes(label)
    if not streams:
        raise RunFolderError(f"'{run.path / (label + '.h5')}' has no spikes")
    return streams


def _has_signals(run, name):
    return any(signal.stream not in MEASURED for signal in run.signals(name))


def _pick(run, words, role, fits):
    for word in words:
        for name in run.labels:
            if word in name.lower() and fits(run, name):
                return name
    recorded = f"recorded: {', '.join(run.labels)}" if run.labels else "nothing is recorded"
    raise RunFolderError(f"no {role} in '{run.path}': {recorded}; write record=true into its "
                         f"section, or name it with --{role} LABEL")


def _note_absence(parts, run):
    if not run.labels or parts.missing:
        return
    for found, what in ((parts.sensors, "sensor"), (parts.spikes, "spikes"),
                        (parts.commands, "command")):
        if not found:
            parts.notes.append(f"no {what} among what is recorded: {', '.join(run.labels)}")


def _describe(parts, run, nodes):
    """Quantities and names of sensors and commands. Programs of .music files have a usual message type."""
    try:
        world = run.world()
    except RunFolderError:
        world = {}  # the trajectory's picture says so
    for signals, usual in ((parts.sensors, "LaserScan"), (parts.commands, "Twist")):
        for signal in signals:
            keys = nodes.get(signal.label, {})
            quantities.describe(signal, keys.get("message") or keys.get("message_type") or usual, keys, world)


def _name_outputs(parts, resolved):
    """Names the channels of a signal that goes to a command after the fields that they set."""
    for connection in resolved.get("connections", []):
        command = resolved["nodes"].get(connection["to"].split(".")[0], {})
        fields = quantities.command_channels(command.get("fields")) if command.get("node") == "ros_command" else []
        for signal in parts.signals if fields else []:
            if f"{signal.label}.{signal.stream}" == connection["from"]:
                paths = {to: f"to {path}" for path, to in fields}
                signal.channels = [paths.get(channel, f"channel {channel}") for channel in range(signal.width)]
