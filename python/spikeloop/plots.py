"""Draws the figures of a run; `spikeloop plot RUN` calls it.

    /usr/bin/python3 -m spikeloop.plots RUN_FOLDER

writes into the folder, if the run has the data:

    trajectory.png  the robot's path through its arena
    spikes.png      sensors, spikes and rates of every population, commands, above one time axis
    signals.png     outputs of the other nodes
    episodes.png    the return of every episode
    latency.png     from a sensor message to the first command computed from it, in wall time

and into the folder of a sweep sweep.png and episodes.png. Missing data are not drawn, and reported on standard error. In
Python:

    from spikeloop.plots import plot_run
    result = plot_run("runs/braitenberg")     # result.pictures, result.missing, result.notes

Exit codes: 0 all data were drawn; 1 some data could not be drawn; 2 an option is invalid; 3 a Python
package is missing; 4 nothing could be drawn.
"""

import argparse
import dataclasses
import pathlib
import sys

FORMATS = ("png", "svg", "pdf")
RUN_FILES = ("resolved.json", "effective.music", "summary.json", "trajectory.csv", "world.json")


@dataclasses.dataclass
class Result:
    pictures: list  # paths of the written files
    missing: list  # one sentence each: what could not be read
    notes: list = dataclasses.field(default_factory=list)  # what this run does not have


class _Painter:
    """Draws the pictures of one folder one after the other."""

    def __init__(self, out, suffix):
        self.out, self.suffix = out, suffix
        out.mkdir(parents=True, exist_ok=True)
        self.result = Result([], [])

    def draw(self, name, paint, wanted=True):
        """wanted: a picture that cannot be drawn is missing, else it is noted."""
        from .run_folder import RunFolderError
        path = self.out / f"{name}.{self.suffix}"
        try:
            self.result.missing += paint(path)
            self.result.pictures.append(path)
        except RunFolderError as error:
            sentences = self.result.missing if wanted else self.result.notes
            sentences.append(f"{path.name} is not drawn: {error}")
        except OSError as error:
            self.result.missing.append(f"cannot write '{path}': {error.strerror}")


def plot_run(folder, out=None, labels=None, begin_s=None, end_s=None, suffix="png"):
    """Draws all pictures of a run, or that of a sweep, into `out` (default: the folder).

    labels: parts.Labels, the section labels of sensor, network and command.
    begin_s, end_s: the part of the time axis, in seconds of simulated time.
    suffix: of the pictures, one of FORMATS.
    Raises RunFolderError when `folder` is not a run folder.
    """
    from . import episodes_plot, parts, sweep_plot, trajectory_plot
    from .run_folder import RunFolder
    run = RunFolder(folder)
    painter = _Painter(pathlib.Path(out) if out else run.path, suffix)
    if (run.path / sweep_plot.TABLE).exists():
        episodic = sorted(file.parent for file in run.path.glob("*/episodes.csv"))
        painter.draw("sweep", lambda path: sweep_plot.draw(run.path, path), wanted=not episodic)
        if episodic:
            painter.draw("episodes", lambda path: episodes_plot.draw(episodic, path))
        return painter.result
    _refuse_other_folders(run)
    found = parts.find(run, labels)
    if found.has_path:
        painter.draw("trajectory", lambda path: trajectory_plot.draw(run, path),
                     wanted=not found.known or (run.path / "trajectory.csv").exists())
    if (run.path / "episodes.csv").exists():
        painter.draw("episodes", lambda path: episodes_plot.draw([run.path], path), wanted=False)
    painter.result.missing += found.missing
    painter.result.notes += found.notes
    _draw_recorded(painter, run, found, begin_s, end_s)
    return painter.result


def _draw_recorded(painter, run, found, begin_s, end_s):
    from . import latency_plot, signals_plot, spikes_plot

    def window():
        return _time_window(found.recorded(), begin_s, end_s)
    painter.draw("spikes", lambda path: spikes_plot.draw(found, path, window()),
                 wanted=not found.known or bool(run.labels))
    if not found.known or not found.recorded():
        return
    painter.draw("signals", lambda path: signals_plot.draw(found, path, window()),
                 wanted=bool(found.signals))
    if not found.simulated:
        painter.draw("latency", lambda path: latency_plot.draw(found, path, window()), wanted=False)


def _time_window(streams, begin_s, end_s):
    """Begin and end in seconds; the run's own where they are None."""
    from .run_folder import RunFolderError
    if not streams:
        raise RunFolderError("neither sensor, spikes nor command is recorded")
    until = max(stream.until_s for stream in streams)
    begin = 0.0 if begin_s is None else begin_s
    end = until if end_s is None else end_s
    if not begin < end or begin >= until:
        raise RunFolderError(f"there is nothing to draw from {begin:g} s to {end:g} s: the "
                             f"recordings go to {until:g} s")
    return begin, end


def _refuse_other_folders(run):
    from .run_folder import RunFolderError
    if not run.labels and not any((run.path / name).exists() for name in RUN_FILES):
        raise RunFolderError(f"'{run.path}' is not a run folder: it has neither a recording (*.h5) nor "
                             f"{', '.join(RUN_FILES[:-1])} or {RUN_FILES[-1]}; name the folder that "
                             "`spikeloop run` wrote")


def _arguments(arguments):
    parser = argparse.ArgumentParser(
        prog="spikeloop.plots", description="Draws the figures of a run.")
    parser.add_argument("folder", metavar="RUN_FOLDER", help="written by `spikeloop run`")
    parser.add_argument("--out", metavar="FOLDER", help="output folder (default: RUN_FOLDER)")
    parser.add_argument("--format", choices=FORMATS, default="png", help="file format")
    parser.add_argument("--sensor", metavar="LABEL", help="process that recorded the sensor")
    parser.add_argument("--network", metavar="LABEL", help="process that recorded the neurons")
    parser.add_argument("--command", metavar="LABEL", help="process that recorded the command")
    parser.add_argument("--from", dest="begin", type=float, metavar="S",
                        help="start of the time axis (s, default 0)")
    parser.add_argument("--to", dest="end", type=float, metavar="S",
                        help="end of the time axis (s, default: end of the run)")
    return parser.parse_args(arguments)


def _fail(message, code):
    print(f"spikeloop: {message}", file=sys.stderr)
    return code


def main(arguments=None):
    given = _arguments(arguments)
    try:
        from . import parts, style  # noqa: F401  (matplotlib)
        from .run_folder import RunFolderError
    except ImportError as error:
        package = (error.name or "matplotlib").split(".")[0]
        return _fail(f"Python's package {package} is missing, or of no use ({error}); "
                     f"apt-get install python3-{package}", 3)
    labels = parts.Labels(given.sensor, given.network, given.command)
    try:
        result = plot_run(given.folder, given.out, labels, given.begin, given.end, given.format)
    except RunFolderError as error:
        return _fail(error, 4)
    except OSError as error:  # the folder to write to
        return _fail(f"cannot make '{error.filename}': {error.strerror}", 4)
    for picture in result.pictures:
        print(picture)
    for sentence in result.missing + result.notes:
        print(f"spikeloop: {sentence}", file=sys.stderr)
    if not result.pictures:
        return 4
    return 1 if result.missing else 0


if __name__ == "__main__":
    sys.exit(main())
