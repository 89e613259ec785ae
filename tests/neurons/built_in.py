"""Runs the built-in network in an experiment, on spikes and signals that a test gives it."""

import collections
import json
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "python"))
sys.path.append(str(HERE.parent / "support"))
sys.path.insert(0, str(HERE.parents[1] / "python"))

import fake_run  # noqa: E402
import recordings  # noqa: E402
from calls import SPIKELOOP, assert_says, refused, spikeloop  # noqa: E402, F401
from folder import FolderCase  # noqa: E402, F401
from spikeloop.run_folder import RunFolder  # noqa: E402

PROGRAMS = pathlib.Path(SPIKELOOP).parent
MS = 1_000_000

Spikes = collections.namedtuple("Spikes", "times_ns channels")


def spikes(pairs):
    """(ns, channel) pairs, sorted, as arrays."""
    pairs = sorted(pairs)
    return Spikes(np.array([time for time, _ in pairs], dtype=np.int64),
                  np.array([channel for _, channel in pairs], dtype=np.int64))


def random_spikes(random, channels, duration_ms, rate_hz):
    """Poisson trains at any nanosecond."""
    pairs = []
    for channel in range(channels):
        count = random.poisson(rate_hz * duration_ms * 1e-3)
        pairs += [(int(time), channel)
                  for time in random.integers(1, duration_ms * MS, size=count)]
    return spikes(pairs)


def on_grid(times_ns, step_ns=100_000):
    """Rounded up."""
    return -(-np.asarray(times_ns) // step_ns) * step_ns


class Run:
    """What a network left behind: `spikes("cell")`, `potential("cell")`, `table("learned.npy")`."""

    def __init__(self, folder, output):
        self.folder = pathlib.Path(folder)
        self.output = output

    def stream(self, name, node="brain"):
        return Spikes(*recordings.spikes(self.folder, node, name))

    def spikes(self, population):
        return self.stream(population + "_spikes")

    def potential(self, population):
        """Times in s, rows of mV."""
        return self.signal(population + "_V_m")

    def signal(self, name):
        recorded = RunFolder(self.folder).signal("brain", name)
        return recorded.times_s, recorded.values

    def table(self, name):
        path = self.folder / f"brain.{name}"
        return np.load(path) if name.endswith(".npy") else json.loads(path.read_text())


def write_inputs(folder, given, width, signal, seconds, tick_s):
    """The recording that the network's ports are fed from; the connections from it."""
    nodes, connections = {}, []
    with fake_run.recording(folder / "inputs.h5", "inputs") as file:
        if width:
            group = file["spikes"].create_group("out")
            group.attrs["width"] = np.uint32(width)
            group.attrs["until_ns"] = np.int64(round(seconds * 1e9))
            group.attrs["dropped"] = np.uint64(0)
            group.create_dataset("timestamps", data=given.times_ns * 1e-6)
            group.create_dataset("timestamps_ns", data=given.times_ns)
            group.create_dataset("node_ids", data=given.channels.astype(np.uint64))
            nodes["source"] = {"node": "spike_playback", "file": "inputs.h5", "stream": "out"}
            connections.append(f"source.out -> brain.in [{width}]")
        if signal is not None:
            # What was recorded at the end of a tick comes in that tick.
            times_s, values = np.asarray(signal[0]) + tick_s, signal[1]
            fake_run.add_signal(file, "level", times_s, values, "1", seconds)
            nodes["level"] = {"node": "signal_playback", "file": "inputs.h5", "stream": "level"}
            connections.append(f"level.out -> brain.signal [{np.shape(values)[1]}]")
    return nodes, connections


def run(folder, network, seconds, given=None, width=0, signal=None, tick="1 ms", seed=1,
        expect=0, arguments=(), sinks=()):
    """`network`: the file's contents as a dictionary, or a path. `signal`: times in s, begins of ticks from
    which on the rows hold, and the rows."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    nodes, connections = write_inputs(folder, given, width, signal, seconds,
                                      float(tick.split()[0]) * 1e-3)
    nodes["brain"] = {"simulator": "builtin", "network": network}
    for name, (keys, connection) in dict(sinks).items():
        nodes[name] = keys
        connections.append(connection)
    experiment = {"experiment": "network", "tick": tick, "duration": f"{seconds} s", "seed": seed,
                  "sync": "unpaced", "nodes": nodes, "connections": connections}
    (folder / "network.yaml").write_text(json.dumps(experiment, indent=1))  # JSON is YAML
    printed = spikeloop("run", folder / "network.yaml", "--out", folder / "run", "--force", *arguments, code=expect)
    return Run(folder / "run", "".join(printed))
