"""Draws what a run left in its folder.

    /usr/bin/python3 -m spikeloop.plots RUN_FOLDER

writes trajectory.png (the robot's path through its arena) and spikes.png (sensor, spikes, rates
and commands above one time axis) into the folder. What is not there is not drawn; a line on
standard error says what is missing. In Python:

    from spikeloop.plots import plot_run
    result = plot_run("runs/braitenberg")     # result.pictures, result.missing

Exit code: 0 everything was drawn; 1 something was missing; 2 a mistake on the command line;
4 nothing could be drawn.
"""

import argparse
import dataclasses
import pathlib
import sys

from . import spikes_plot, trajectory_plot
from .run_folder import RunFolder, RunFolderError


@dataclasses.dataclass
class Result:
    pictures: list  # paths of the written files
    missing: list  # one sentence each


def plot_run(folder, out=None, labels=None, begin_s=None, end_s=None):
    """Draws both pictures into `out` (default: the run folder).

    labels: spikes_plot.Labels, the section labels of sensor, network and command.
    begin_s, end_s: the part of spikes.png's time axis, in seconds of simulated time.
    Raises RunFolderError when `folder` is no folder.
    """
    run = RunFolder(folder)
    out = pathlib.Path(out) if out else run.path
    out.mkdir(parents=True, exist_ok=True)
    result = Result([], [])
    pictures = {
        "trajectory.png": lambda path: trajectory_plot.draw(run, path),
        "spikes.png": lambda path: spikes_plot.draw(run, path, labels, begin_s, end_s),
    }
    for name, draw in pictures.items():
        try:
            result.missing += draw(out / name)
            result.pictures.append(out / name)
        except RunFolderError as error:
            result.missing.append(f"{name} is not drawn: {error}")
    return result


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="spikeloop.plots", description="Draws trajectory.png and spikes.png from a run folder.")
    parser.add_argument("folder", metavar="RUN_FOLDER", help="what `spikeloop run --out` wrote")
    parser.add_argument("--out", metavar="FOLDER", help="where to write (default: RUN_FOLDER)")
    parser.add_argument("--sensor", metavar="LABEL", help="process that recorded the sensor")
    parser.add_argument("--network", metavar="LABEL", help="process that recorded the neurons")
    parser.add_argument("--command", metavar="LABEL", help="process that recorded the command")
    parser.add_argument("--from", dest="begin", type=float, metavar="S",
                        help="begin of spikes.png (s, default 0)")
    parser.add_argument("--to", dest="end", type=float, metavar="S",
                        help="end of spikes.png (s, default: end of the run)")
    given = parser.parse_args(arguments)
    labels = spikes_plot.Labels(given.sensor, given.network, given.command)
    try:
        result = plot_run(given.folder, given.out, labels, given.begin, given.end)
    except RunFolderError as error:
        print(f"spikeloop.plots: {error}", file=sys.stderr)
        return 4
    for picture in result.pictures:
        print(picture)
    for sentence in result.missing:
        print(f"spikeloop.plots: {sentence}", file=sys.stderr)
    if not result.pictures:
        return 4
    return 1 if result.missing else 0


if __name__ == "__main__":
    sys.exit(main())
