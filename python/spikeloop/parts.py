"""Which recorded node or process plays which part: sensor, neurons, command.

An experiment's run folder says what its nodes are (resolved.json), that of a MUSIC job which
programs ran (effective.music); names decide nothing. Everything stands in the order of the data.
"""

import dataclasses
import re

from .run_folder import RunFolderError, require_regular

SENSORS = ("ros_sensor", "signal_playback", "ros_sensor_adapter", "ros_cont_adapter",
           "zmq_cont_adapter")
COMMANDS = ("ros_command", "ros_command_adapter", "cont_ros_adapter", "cont_zmq_adapter")
MEASURED = ("pace", "latency")  # signals about the loop, not in it


@dataclasses.dataclass
class Parts:
    """What a run recorded: run_folder's Signal and Spikes."""

    sensors: list = dataclasses.field(default_factory=list)
    spikes: list = dataclasses.field(default_factory=list)
    signals: list = dataclasses.field(default_factory=list)  # between sensors and commands
    commands: list = dataclasses.field(default_factory=list)
    latencies: list = dataclasses.field(default_factory=list)
    notes: list = dataclasses.field(default_factory=list)  # what this run does not have
    missing: list = dataclasses.field(default_factory=list)  # what cannot be read


def find(run):
    """The parts of an experiment's or a MUSIC job's run; None where nothing says what ran."""
    kinds = _experiment(run) or _music_job(run)
    if kinds is None:
        return None
    parts = Parts()
    for label in _recorded(run, kinds, parts):
        try:
            _add(parts, run, label, kinds[label])
        except RunFolderError as error:
            parts.missing.append(str(error))
    _note_absence(parts, run)
    return parts


def clock(run):
    """What latencies are measured with: "simulated time" when nothing reads the wall clock."""
    try:
        resolved = run.resolved()
    except RunFolderError:
        return "wall time"
    return "simulated time" if resolved.get("ros", "1") == "none" else "wall time"


def _experiment(run):
    if not (run.path / "resolved.json").exists():
        return None
    resolved = run.resolved()
    nodes = resolved.get("nodes")
    if not isinstance(nodes, dict):
        raise RunFolderError(f"'{run.path / 'resolved.json'}' has no 'nodes': it is not what "
                             "`spikeloop run` wrote")
    ends = [connection[end] for connection in resolved.get("connections", [])
            for end in ("from", "to")]
    return _in_order({name: keys.get("node", "") for name, keys in nodes.items()}, ends)


def _music_job(run):
    require_regular(run.path / "effective.music")
    try:
        text = (run.path / "effective.music").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    kinds, label = {}, None
    for line in text.splitlines():
        if section := re.match(r"\s*\[(.+)\]\s*$", line):
            label = section[1].strip()
            kinds[label] = ""
        elif label and (key := re.match(r"\s*binary\s*=\s*(.+?)\s*$", line)):
            kinds[label] = key[1].rsplit("/", 1)[-1]
    ends = [end for arrow in re.findall(r"(\S+)\s*->\s*(\S+)", text) for end in arrow]
    return _in_order(kinds, ends)


def _in_order(kinds, ends):
    """Those that connections name come first, as the data go through them."""
    names = [end.split(".")[0] for end in ends] + list(kinds)
    return {name: kinds[name] for name in dict.fromkeys(names) if name in kinds}


def _recorded(run, kinds, parts):
    if not run.labels:
        parts.notes.append("nothing is recorded: run without --no-record, a .music file with "
                           "--record")
    return [label for label in kinds if label in run.labels]


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


def _note_absence(parts, run):
    if not run.labels or parts.missing:
        return
    for found, what in ((parts.sensors, "sensor"), (parts.spikes, "spikes"),
                        (parts.commands, "command")):
        if not found:
            parts.notes.append(f"no {what} among what is recorded: {', '.join(run.labels)}")
