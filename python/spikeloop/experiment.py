"""Experiments from Python: read a file, change keys, run it, read what it recorded.

    import spikeloop

    experiment = spikeloop.load("explorer.yaml")
    experiment["encoder.rate_max"] = "100 Hz"
    run = experiment.run(seed=3, duration="60 s", sync="lockstep")
    print(run.summary()["distance_m"], run["encoder"].spikes.times_s)

Every run is a process of its own, `spikeloop run`, and gives what the command line gives. Nothing is
printed; what goes wrong is a SpikeloopError.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile

from .run_folder import RunFolder


class SpikeloopError(Exception):
    """What `spikeloop` refused, or why a run failed.

    code: of the error, such as "SL0202", which `spikeloop explain` describes; None when it has none.
    exit_code: of the program. messages: everything that it printed.
    """

    def __init__(self, message, exit_code, messages=()):
        super().__init__(message)
        found = re.search(r"\[(SL\d{4})\]$", message)
        self.code = found.group(1) if found else None
        self.exit_code = exit_code
        self.messages = list(messages)


def program():
    """The path of `spikeloop`: beside this package, or in PATH. @raises SpikeloopError"""
    named = os.environ.get("SPIKELOOP_PROGRAMS")
    beside = pathlib.Path(named) if named else pathlib.Path(__file__).absolute().parents[4] / "bin"
    found = shutil.which("spikeloop", path=str(beside)) or shutil.which("spikeloop")
    if found is None:
        raise SpikeloopError(f"there is no program 'spikeloop' in '{beside}' or in PATH; install it, or set "
                             "SPIKELOOP_PROGRAMS to the directory of the programs", 3)
    return found


def value_text(value):
    """A Python value as it stands in an experiment file."""
    if isinstance(value, str):
        return value
    if hasattr(value, "tolist"):  # of NumPy
        value = value.tolist()
    return json.dumps(value)


def setting_words(settings):
    """Arguments `--set` for a dictionary of keys and values."""
    return [word for key, value in settings.items() for word in ("--set", f"{key}={value_text(value)}")]


def call(*words):
    """Standard output of `spikeloop WORDS`. @raises SpikeloopError; KeyboardInterrupt after its end"""
    with subprocess.Popen([program(), *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          stdin=subprocess.DEVNULL, text=True) as process:
        try:
            out, said = process.communicate()
        except KeyboardInterrupt:  # which a terminal sends to both
            process.communicate()
            raise
    if process.returncode != 0:
        lines = said.splitlines()
        errors = [line for line in lines if line.startswith(("error: ", "spikeloop: "))]
        first = next((line for line in errors if line.startswith("error: ")), errors[-1] if errors else
                     f"spikeloop {words[0]} ended with exit code {process.returncode}")
        raise SpikeloopError(first.partition(": ")[2] or first, process.returncode, lines)
    return out


class Run(RunFolder):
    """A run that has ended: spikes, signals, trajectory, summary and counters (spikeloop.run_folder)."""

    def __init__(self, path, temporary=None):
        super().__init__(path)
        self._temporary = temporary  # the folder lives as long as this object


class Experiment:
    """An experiment file, and the keys that are set in place of those it has.

    A key is one of the experiment ("seed"), of a node ("encoder.rate_max"), of the robot
    ("robot.world"), or lies in a value that is a map or a list ("brain.network.connections.0.delay").
    Reading a key gives its value with every default, numbers in the units of `spikeloop describe`.
    """

    def __init__(self, file, settings=None):
        self.file = pathlib.Path(file)
        self.settings = dict(settings or {})

    def __setitem__(self, key, value):
        self.settings[key] = value

    def __getitem__(self, key):
        resolved = self.resolved()
        node, dot, name = key.removeprefix("nodes.").partition(".")
        values = resolved["nodes"].get(node, {}) if dot else resolved
        if dot and node == "robot":
            values = resolved.get("robot", {})
        name = name or node
        if name not in values:
            raise KeyError(key)
        return values[name]

    def resolved(self):
        """The whole experiment as a dictionary, with every default, width and delay."""
        return json.loads(call("check", "--json", self.file, *setting_words(self.settings)))

    def run(self, *, seed=None, duration=None, sync=None, ros=None, layout=None, set=None, out=None,
            force=False, record=True):
        """Runs the experiment to its end.

        set: keys and values for this run alone. out: the run folder; without it the folder is
        temporary and goes with the result. force: replaces the results of a run in it. record: False leaves out the outputs of nodes.
        @raises SpikeloopError: the file or a setting is wrong, the run failed.
        """
        settings = {**self.settings, **(set or {})}
        for key, value in (("seed", seed), ("duration", duration), ("sync", sync), ("ros", ros),
                           ("layout", layout)):
            if value is not None:
                settings[key] = value
        temporary = None if out else tempfile.TemporaryDirectory(prefix="spikeloop-")
        folder = out or temporary.name
        call("run", "-q", self.file, "--out", folder, *(["--force"] if force else []), *([] if record else ["--no-record"]),
             *setting_words(settings))
        return Run(folder, temporary)


def load(file, settings=None):
    """An Experiment that has been checked. @raises SpikeloopError"""
    experiment = Experiment(file, settings)
    experiment.resolved()
    return experiment
