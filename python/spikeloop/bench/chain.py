"""What is run: a laser's scan, encoded, repeated by a simulator or not, decoded.

    scan [100] -> spread [neurons] -> encoder -> (brain) -> decoder [2] -> motor

The scan changes 20 times a second. `spread` has uniform weights, so that every neuron gets the mean of
all beams, as with the paper's scripts; the NEF population gets 16 means of neighbouring beams. The
same experiment file in both layouts.
"""

import dataclasses
import json
import math
import pathlib
import shutil

import h5py
import numpy as np

BEAMS = 100
SCAN_MS = 50
DIMENSIONS = 16  # of the NEF population
RESOLUTION_MS = 1  # of simulators with a grid
ENCODERS = {"rate": "rate_encoder", "poisson": "poisson_encoder", "nef": "nef_encoder"}
SCRIPTS = {"nest": "repeat_nest.py", "neuron": "repeat_neuron.py", "brian2": "repeat_brian2.py"}
HERE = pathlib.Path(__file__).resolve().parent

NETWORK = """resolution: {resolution} ms
populations:
  input: {{model: input, size: {neurons}}}
  relay: {{model: repeater, size: {neurons}}}
connections:
  - {{from: input, to: relay, rule: one_to_one, delay: {resolution} ms}}
output: [relay]
"""
EXPERIMENT = """experiment: bench
layout: {layout}
duration: {duration_s} s
tick: {tick_ms} ms
sync: unpaced
nodes:
  scan: {{node: signal_playback, file: scan.h5}}
  spread: {{node: connect, weights: {weights}}}
  encoder: {{node: {encoder}, {keys}}}
{brain}  decoder: {{node: linear_readout, tau: 30 ms, weights: uniform}}
  motor: {{node: low_pass, tau: 50 ms}}
connections:
  - scan -> spread [{beams}] -> encoder [{inputs}] -> {through}decoder [{neurons}] -> motor [2]
"""


@dataclasses.dataclass(frozen=True)
class Setting:
    """What one point of a curve is."""
    layout: str  # fused, separate; alone: a simulator by itself
    encoder: str  # rate, poisson, nef
    simulator: str  # none, builtin, nest, neuron, brian2
    tick_ms: float
    neurons: int
    rate_min_hz: float  # of rate and Poisson neurons
    rate_max_hz: float
    duration_s: float  # simulated

    def keys(self):
        return dataclasses.asdict(self)

    @property
    def inputs(self):
        return DIMENSIONS if self.encoder == "nef" else self.neurons

    @property
    def ticks(self):
        return round(self.duration_s * 1000 / self.tick_ms)


def scan_values(rows):
    """The beams, a row a scan: a wave that wanders over them, within [-0.9, 0.9]."""
    times_s = np.arange(rows)[:, None] * SCAN_MS / 1000
    beams = np.arange(BEAMS)[None, :]
    return 0.9 * np.sin(2 * np.pi * (0.37 * times_s + beams / (4 * BEAMS)))


def write_scan(path, duration_s):
    """A recording as a run leaves it, which signal_playback plays."""
    rows = math.ceil(duration_s * 1000 / SCAN_MS) + 1
    times = np.arange(rows, dtype=np.int64) * SCAN_MS * 1_000_000
    with h5py.File(path, "w") as file:
        file.attrs.update({"process": "scan", "seed": 1, "tick_ns": SCAN_MS * 1_000_000,
                           "spikeloop_format": 1, "complete": 1})
        group = file.create_group("signals/out")
        group.attrs.update({"width": np.uint32(BEAMS), "until_ns": times[-1], "dropped": 0})
        group["times_ns"] = times
        group["values"] = scan_values(rows)
        group["values"].attrs["unit"] = "1"


def expected_spikes_a_neuron(setting):
    """The integral of a rate or Poisson neuron's rate over the run, by theory.

    A scan of time t counts from the begin of the tick that holds t; in the separate layout a tick
    later behind each of the two continuous connections, before which the encoder is silent.
    """
    hops = 2 if setting.layout == "separate" else 0
    means = scan_values(setting.ticks + 2).mean(axis=1)
    ends_ms = np.arange(1, setting.ticks + 1 - hops) * setting.tick_ms
    rows = np.floor(ends_ms / SCAN_MS + 1e-9).astype(int)
    middle = (setting.rate_min_hz + setting.rate_max_hz) / 2
    half_range = (setting.rate_max_hz - setting.rate_min_hz) / 2
    return float(np.sum(middle + half_range * means[rows]) * setting.tick_ms / 1000)


def write(setting, folder):
    """The files of a run; the name of the one to run."""
    write_scan(folder / "scan.h5", setting.duration_s)
    weights = "uniform"
    if setting.encoder == "nef":
        weights = "beams.json"
        groups = np.array_split(np.arange(BEAMS), DIMENSIONS)
        rows = [[1 / len(group) if beam in group else 0 for beam in range(BEAMS)]
                for group in groups]
        (folder / weights).write_text(json.dumps(rows))
    if setting.simulator == "builtin":
        (folder / "network.yaml").write_text(NETWORK.format(neurons=setting.neurons,
                                                            resolution=RESOLUTION_MS))
    keys = {"preset": "rma"}
    if setting.encoder != "nef":
        keys = {"rate_min": f"{setting.rate_min_hz:g} Hz", "rate_max": f"{setting.rate_max_hz:g} Hz"}
    brain, through = "", ""
    if setting.simulator != "none":
        what = (f"script: {_copy_script(setting.simulator, folder)}"
                if setting.simulator in SCRIPTS else "network: network.yaml")
        brain = f"  brain: {{simulator: {setting.simulator}, {what}}}\n"
        through = f"brain [{setting.neurons}] -> "
    (folder / "job.yaml").write_text(EXPERIMENT.format(
        layout=setting.layout, duration_s=setting.duration_s, tick_ms=setting.tick_ms, beams=BEAMS,
        weights=weights, encoder=ENCODERS[setting.encoder], inputs=setting.inputs,
        keys=", ".join(f"{key}: {value}" for key, value in keys.items()), brain=brain,
        through=through, neurons=setting.neurons))
    return "job.yaml"


def _copy_script(simulator, folder):
    name = SCRIPTS[simulator]
    shutil.copy(HERE / "brains" / name, folder)
    return name
