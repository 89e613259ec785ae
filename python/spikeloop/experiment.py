"""Experiments from Python: read a file, change keys, run it, read what it recorded.

    import spikeloop

    experiment = spikeloop.load("explorer.yaml")
    experiment["encoder.rate_max"] = "100 Hz"
    run = experiment.run(seed=3, duration="60 s", sync="lockstep")
    print(run.summary()["distance_m"], run["encoder"].spikes.times_s)

Every run is a process of its own, `spikeloop run`, and gives what the command line gives. Nothing is
printed; what goes wrong is a SpikeloopError.
"""

import contextlib
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import threading
import warnings
import weakref

import numpy as np

from .run_folder import RunFolder, SpikeloopError


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
    """A Python value as it stands in an experiment file; a text is no list and no map there."""
    if hasattr(value, "tolist"):  # of NumPy
        value = value.tolist()
    return json.dumps(value, ensure_ascii=False, default=str)


LONGEST = 100_000  # characters that the system takes as one argument


def setting_words(settings, text=value_text):
    """Arguments `--set` for a dictionary of keys and values. @raises SpikeloopError: a value is too long"""
    words = [f"{key}={text(value)}" for key, value in settings.items()]
    for word in words:
        if len(word) > LONGEST:
            key = word.partition("=")[0]
            raise SpikeloopError(f"the value of '{key}' has {len(word)} characters, more than {LONGEST}; save it as a "
                                 "file, and set its path", 2)
    return [argument for word in words for argument in ("--set", word)]


@contextlib.contextmanager
def suspending(processes):
    """While the block runs, Ctrl-Z also suspends these processes, and fg continues them: they have sessions of their
    own, which the terminal does not signal.
    @param processes returns the running ones as a list of Popen"""
    def suspend(*_):
        for process in processes():
            process.send_signal(signal.SIGTSTP)
        os.kill(os.getpid(), signal.SIGSTOP)
        for process in processes():
            process.send_signal(signal.SIGCONT)

    if threading.current_thread() is not threading.main_thread():
        yield  # Python permits signal handlers in the main thread only
        return
    before = signal.signal(signal.SIGTSTP, suspend)
    try:
        yield
    finally:
        signal.signal(signal.SIGTSTP, before)


def call(*words):
    """Standard output of `spikeloop WORDS`. @raises SpikeloopError; KeyboardInterrupt after its end"""
    try:
        # Ended with this process, however that ends.
        process = subprocess.Popen(["setpriv", "--pdeathsig", "INT", program(), *map(str, words)],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   stdin=subprocess.DEVNULL, text=True, start_new_session=True)
    except (OSError, ValueError) as error:  # too many settings, a zero byte
        raise SpikeloopError(f"spikeloop {words[0]} cannot be started: {error}", 3) from None
    with process, suspending(lambda: [process]):
        try:
            out, said = process.communicate()
        except KeyboardInterrupt:  # not of the process, whose session is its own
            process.send_signal(signal.SIGINT)
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

    def __init__(self, path, temporary=False):
        super().__init__(path)
        if temporary:  # the folder lives as long as this object
            weakref.finalize(self, shutil.rmtree, path, ignore_errors=True)


class Experiment:
    """An experiment file, and the keys that are set in place of those it has.

    A key is one of the experiment ("seed"), of a node ("encoder.rate_max"), of the robot
    ("robot.world"), or lies in a value that is a map or a list ("brain.network.connections.0.delay").
    Reading a key of the experiment, a node or the robot gives its value with every default, numbers in the units
    of `spikeloop describe`. `settings` has what was set; `del experiment[key]` takes it back.
    """

    def __init__(self, file, settings=None):
        self.file = pathlib.Path(file)
        self.settings = dict(settings or {})

    def __setitem__(self, key, value):
        self.settings[key] = value

    def __delitem__(self, key):
        """Takes a setting back. @raises KeyError"""
        del self.settings[key]

    def __getitem__(self, key):
        """@raises KeyError; SpikeloopError when a setting is wrong"""
        resolved, found = self.resolved(), {}
        for node, keys in {**resolved["nodes"], "robot": resolved.get("robot", {})}.items():
            found[f"nodes.{node}"] = found[node] = keys
            found.update({f"{node}.{name}": value for name, value in keys.items()})
        found.update(resolved)
        for name in ("duration", "tick"):
            found[name] = resolved[f"{name}_ns"] and resolved[f"{name}_ns"] * 1e-9
        if key.removeprefix("nodes.") in found:
            return found[key.removeprefix("nodes.")]
        return self.settings[key]  # within the value of another key

    def resolved(self):
        """The whole experiment as a dictionary, with every default, width and delay."""
        return json.loads(call("check", "--json", *setting_words(self.settings), "--", self.file))

    def open(self, *, seed=None, duration=None, sync=None, set=None, out=None):
        """The experiment in this process, to be stepped: `with experiment.open() as loop: ...`.

        As run(), but without ROS, and with the layout fused. out: a run folder to record in. Nodes that are
        simulators (`simulator: python`) do not run: the caller reads their inputs, and writes their outputs.
        @raises SpikeloopError
        """
        return Loop(self.file, self._with(set, seed=seed, duration=duration, sync=sync), out)

    def _with(self, more, **keys):
        """The settings with these, as far as they are given."""
        return {**self.settings, **(more or {}), **{key: value for key, value in keys.items() if value is not None}}

    def run(self, *, seed=None, duration=None, sync=None, ros=None, layout=None, set=None, out=None,
            force=False, record=True):
        """Runs the experiment to its end.

        set: a dictionary of keys and values for this run alone. out: the run folder; without it the folder is
        temporary and goes with the result. force: replaces the results of a run in it. record: False leaves out
        the outputs of nodes.
        @raises SpikeloopError: the file or a setting is wrong, the run failed.
        """
        settings = self._with(set, seed=seed, duration=duration, sync=sync, ros=ros, layout=layout)
        folder = out or tempfile.mkdtemp(prefix="spikeloop-")
        try:
            self._run(folder, settings, force, record)
        except BaseException:
            if out is None:
                shutil.rmtree(folder, ignore_errors=True)
            raise
        return Run(folder, temporary=out is None)

    def _run(self, folder, settings, force, record):
        call("run", "-q", "--out", folder, *(["--force"] if force else []), *([] if record else ["--no-record"]),
             *setting_words(settings), "--", self.file)


class Loop:
    """A run under way, tick by tick.

    loop.step(10); loop.spikes("encoder.out"); loop.signal("decoder.out"). An end is "NODE.PORT" of an
    output, "NODE.command" of a command, or an input of a simulator.
    """

    def __init__(self, file, settings, out):
        from . import music_library
        # Worlds and libraries are found beside Spikeloop's programs, and this process is none of them.
        prefix = pathlib.Path(program()).absolute().parents[1]
        os.environ.setdefault("SPIKELOOP_SHARE", str(prefix / "share/spikeloop"))
        os.environ.setdefault("SPIKELOOP_LIBRARY_PATH", str(prefix / "lib/spikeloop"))
        self._module = music_library.library("spikeloop_python_loop", "Experiment.open")
        self.folder = None
        if out is not None:
            self.folder = pathlib.Path(out)
            if self.folder.is_dir() and any(self.folder.iterdir()):
                raise SpikeloopError(f"the folder '{out}' is not empty; give another one", 2)
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise SpikeloopError(f"cannot make the folder '{out}': {error.strerror}", 4) from None
        plain = json.dumps([[key, value_text(value), f"set {key}"] for key, value in settings.items()])
        self._loop = self._call(self._module.Loop, str(file), plain, str(self.folder.absolute()) if out else "")
        self._result = None

    def _call(self, function, *arguments):
        try:
            return function(*arguments)
        except self._module.Failure as error:
            raise SpikeloopError(*error.args) from None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    @property
    def time_s(self):
        """Simulated seconds."""
        return self._loop.time() * 1e-9

    @property
    def tick_s(self):
        """Seconds of a tick."""
        return self._loop.tick() * 1e-9

    @property
    def outputs(self):
        """Ends that can be read: their kind ("spikes", "signal") and width."""
        return self._loop.outputs()

    @property
    def inputs(self):
        """Ends that can be written, outputs of simulators: their kind and width."""
        return self._loop.inputs()

    @property
    def episode(self):
        """Of the robot's task, the newest: number, running, steps, return, terminated, success, step_ns (of a step).
        None: the robot has no task."""
        return self._loop.episode()

    def step(self, ticks=1):
        """Advances by this many ticks, or as many as are left. @returns whether there was one.
        @raises SpikeloopError: a node failed"""
        done = self._call(self._loop.step, ticks) if self._result is None else 0
        for text in self._loop.warnings():
            warnings.warn(text, stacklevel=2)
        if done < ticks:
            self._finish()
            if self._result[0] != 0:
                raise SpikeloopError(self._result[1], self._result[0])
        return done > 0

    def spikes(self, end):
        """What it sent in the last step(): (times in s, channels). @raises SpikeloopError: no such end"""
        times_ns, channels = self._call(self._loop.spikes, end)
        return times_ns * 1e-9, channels.astype(np.int64)

    def signal(self, end):
        """Its newest values; None before the first one. @raises SpikeloopError: no such end"""
        return self._call(self._loop.signal, end)

    def send(self, end, times_s, channels):
        """Spikes of a simulator in the last tick; they arrive in the next one. Times to the nanosecond.
        @raises SpikeloopError: no such end, a time outside of the tick, a channel that it has not"""
        times_s, given = np.asarray(times_s, dtype=float), np.asarray(channels)
        channels = given.astype(np.int64)
        if not (np.isfinite(times_s).all() and (channels == given).all()):
            raise SpikeloopError(f"{end}: a spike at {times_s} s of channel {given}; write finite times and whole numbers "
                                 "of channels", 2)
        self._call(self._loop.send, end, np.rint(times_s * 1e9).astype(np.int64), channels)

    def write(self, end, values):
        """The signal of a simulator, from the next tick on. @raises SpikeloopError: no such end, other width"""
        self._call(self._loop.write, end, np.asarray(values, dtype=float))

    def _finish(self):
        if self._result is None:
            self._result = self._call(self._loop.finish)

    def close(self):
        """Ends the run; the robot stops. Recordings and summary.json are complete then."""
        self._finish()

    def summary(self):
        """Ends the run. @returns its results"""
        self._finish()
        return json.loads(self._result[2])

    def run(self):
        """Ends the run, and reads what it recorded. @raises SpikeloopError: open() had no `out`"""
        if self.folder is None:
            raise SpikeloopError("nothing was recorded; write open(out=FOLDER)", 2)
        self._finish()
        return Run(self.folder)


def load(file, settings=None):
    """An Experiment that has been checked. @raises SpikeloopError"""
    experiment = Experiment(file, settings)
    experiment.resolved()
    return experiment


def open_run(path):
    """The run whose folder is there. @raises SpikeloopError: it is no run folder"""
    return Run(path)
