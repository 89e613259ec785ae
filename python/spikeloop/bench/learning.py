"""`spikeloop bench --learning`: learning over many seeds, beside what was published.

Sweeps of what `spikeloop new --environment` prints: mountain car and frozen lake (Jordan, Weidel & Morrison 2019,
Front. Comput. Neurosci. 13:46, one published run each), T-maze and lane with and without reward, and the water maze with
actors that learn and that do not. The table has medians and quartiles of the seeds. Options are checked and explained in
C++ (bench_command.cpp).
"""

import argparse
import pathlib
import subprocess

import numpy as np

from ..experiment import open_run
from ..whole_file import write_whole
from .results import ResultsError

# The learning rates that were published.
PUBLISHED_RATES = {"mountain_car": ("--set", "brain.network.connections.7.plasticity.A=0.25"),
                   "frozen_lake": ("--set", "brain.network.connections.6.plasticity.A=0.01")}
WITHOUT_REWARD = ("--set", "brain.network.connections.1.weight=0")
WITHOUT_LEARNING = ("--set", "brain.network.connections.4.plasticity.A_plus=0")
# The parameters were chosen on other seeds.
FIRST_SEED = {"mountain_car": 101, "frozen_lake": 101, "t_maze": 401, "lane": 11, "water_maze": 101}
STEP_S = 0.1  # of the water maze


class Failed(Exception):
    """A program that ended with an error, which it has printed."""


class Bench:
    """Where the program is, where the sweeps go, and how many seeds they have."""

    def __init__(self, programs, out, seeds):
        self.spikeloop, self.out, self.seeds = programs / "spikeloop", out, seeds

    def runs(self, task, name=None, settings=()):
        """Episodes of every run of a sweep of what `spikeloop new` prints, in the folder `name`."""
        file = self.out / f"{task}.yaml"
        text = self._call("new", "--environment", task)
        try:
            self.out.mkdir(parents=True, exist_ok=True)
            write_whole(file, text)
        except OSError as error:
            raise ResultsError(f"cannot write '{file}': {error.strerror}") from None
        first = FIRST_SEED[task]
        folder = self.out / (name or task)
        self._call("sweep", file, "--set", f"seed={first}..{first + self.seeds - 1}", *settings, "--out", folder)
        return [open_run(path.parent).episodes() for path in sorted(folder.glob("*/episodes.csv"))]

    def _call(self, *words):
        done = subprocess.run([self.spikeloop, *words], stdout=subprocess.PIPE, text=True, check=False)
        if done.returncode != 0:
            raise Failed(done.returncode)
        return done.stdout


def row(name, published, values):
    low, median, high = np.percentile(values, (25, 50, 75))
    print(f"{name:<62}{published:>10}{median:>10.4g}  ({low:.4g} to {high:.4g})", flush=True)


def both_rates(bench, task):
    """(text, episodes of every run): with the published learning rate, and with that of the experiment."""
    return (("published rate", bench.runs(task, f"{task}_published", PUBLISHED_RATES[task])),
            ("rate chosen here", bench.runs(task)))


def mountain_car(bench):
    for text, tables in both_rates(bench, "mountain_car"):
        learned = [table["return"][10:50] for table in tables]
        row(f"mountain car, {text}, episodes 11 to 50: median", "-130", [np.median(values) for values in learned])
        row("  mean return", "-308", [values.mean() for values in learned])
        row("  best return of a run", "-84", [table["return"].max() for table in tables])
        row("  of the first 50, with at least -110", "10", [(table["return"][:50] >= -110).sum() for table in tables])


def frozen_lake(bench):
    for text, tables in both_rates(bench, "frozen_lake"):
        failed = [np.flatnonzero(table["success"] == 0) for table in tables]
        steps = [table["steps"].cumsum() for table in tables]
        row(f"frozen lake, {text}, steps until the last failure", "1700",
            [count[last[-1]] if len(last) else 0 for count, last in zip(steps, failed)])
        row("  steps of a run", "3961", [count[-1] for count in steps])


def t_maze(bench):
    for name, settings in (("with", ()), ("without", WITHOUT_REWARD)):
        tables = bench.runs("t_maze", f"t_maze_{name}", settings)
        for text, part in (("first 20", slice(0, 20)), ("last 20", slice(-20, None))):
            row(f"T-maze {name} reward, success of the {text} (%)", "-",
                [100 * table["success"][part].mean() for table in tables])


def lane(bench):
    for name, settings in (("with", ()), ("without", ("--set", "reward.function=0; 0"))):
        tables = bench.runs("lane", f"lane_{name}", settings)
        row(f"lane {name} reward, success of the last 10 (%)", "-",
            [100 * table["success"][-10:].mean() for table in tables])


def water_maze(bench):
    for name, settings in (("learning", ()), ("fixed", WITHOUT_LEARNING)):
        tables = bench.runs("water_maze", f"water_maze_{name}", settings)
        for begin, end in ((1, 5), (6, 10), (11, 20), (21, 30)):
            part = slice(begin - 1, end)
            row(f"water maze, {name} actors, {begin} to {end}: success (%)", "-",
                [100 * table["success"][part].mean() for table in tables])
            row("  median latency (s)", "-", [STEP_S * np.median(table["steps"][part]) for table in tables])


TASKS = {"mountain_car": mountain_car, "frozen_lake": frozen_lake, "t_maze": t_maze, "lane": lane,
         "water_maze": water_maze}


def run(words):
    """Measures and prints the table. Returns the exit code."""
    parser = argparse.ArgumentParser(prog="spikeloop bench --learning")
    parser.add_argument("--programs", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--seeds", type=int, required=True)
    parser.add_argument("--tasks", type=lambda text: text.split(","), required=True)
    parser.add_argument("--learning", action="store_true")
    given = parser.parse_args(words)
    print(f"{'':<62}{'published':>10}{'median':>10}  (quartiles of {given.seeds} seeds)", flush=True)
    try:
        for task in given.tasks:
            TASKS[task](Bench(given.programs, given.out, given.seeds))
    except Failed as failed:
        return failed.args[0]
    except KeyboardInterrupt:
        return 130
    return 0
