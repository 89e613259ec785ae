#!/usr/bin/python3
"""Learning over many seeds, beside what was published.

    benchmarks/learning/learning.py --seeds 100 --out FOLDER

runs `spikeloop new --environment` for the mountain car, the frozen lake (Jordan, Weidel & Morrison 2019,
Front. Comput. Neurosci. 13:46, one published run each), the T-maze and the lane with and without reward, and
example 21, the water maze, with actors that learn and that do not. It prints medians and quartiles of the seeds.
FOLDER keeps the sweeps with their learning curves, episodes.png; a second call continues. 100 seeds take more
than an hour on two cores, most of it in the mazes and on the lane.
"""

import argparse
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPIKELOOP = ROOT / "build/release/bin/spikeloop"
sys.path.insert(0, str(ROOT / "python"))
# The learning rates that were published; those of the experiments were chosen on seeds 1 to 20.
PUBLISHED_RATES = {"mountain_car": ("--set", "brain.network.connections.7.plasticity.A=0.25"),
                   "frozen_lake": ("--set", "brain.network.connections.6.plasticity.A=0.01")}
WITHOUT_REWARD = ("--set", "brain.network.connections.3.weight=0")
WITHOUT_LEARNING = ("--set", "brain.network.connections.4.plasticity.A_plus=0")
WATER_MAZE = ROOT / "examples/21_water_maze"
STEP_S = 0.1  # of the water maze


def runs(environment, folder, seeds, settings=()):
    """Episodes of every run of a sweep of what `spikeloop new` prints."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder.parent / f"{environment}.yaml"
    file.write_text(subprocess.run([SPIKELOOP, "new", "--environment", environment], check=True,
                                   capture_output=True, text=True).stdout)
    return sweep(file, folder, range(1, seeds + 1), settings)


def sweep(file, folder, seeds, settings):
    from spikeloop import open_run
    subprocess.run([SPIKELOOP, "sweep", file, "--set", f"seed={seeds[0]}..{seeds[-1]}", *settings, "--out", folder],
                   check=True, stdout=subprocess.DEVNULL)
    return [open_run(path.parent).episodes() for path in sorted(folder.glob("*/episodes.csv"))]


def row(name, published, values):
    low, median, high = np.percentile(values, (25, 50, 75))
    print(f"{name:<62}{published:>10}{median:>10.4g}  ({low:.4g} to {high:.4g})", flush=True)


def both_rates(task, folder, seeds):
    """(text, episodes of every run): with the published learning rate, and with that of the experiment."""
    return (("published rate", runs(task, folder.with_name(f"{task}_published"), seeds, PUBLISHED_RATES[task])),
            ("rate chosen here", runs(task, folder, seeds)))


def mountain_car(folder, seeds):
    for text, tables in both_rates("mountain_car", folder, seeds):
        learned = [table["return"][10:50] for table in tables]
        row(f"mountain car, {text}, episodes 11 to 50: median", "-130", [np.median(values) for values in learned])
        row("  mean return", "-308", [values.mean() for values in learned])
        row("  best return of a run", "-84", [table["return"].max() for table in tables])
        row("  of the first 50, with at least -110", "10", [(table["return"][:50] >= -110).sum() for table in tables])


def frozen_lake(folder, seeds):
    for text, tables in both_rates("frozen_lake", folder, seeds):
        failed = [np.flatnonzero(table["success"] == 0) for table in tables]
        steps = [table["steps"].cumsum() for table in tables]
        row(f"frozen lake, {text}, steps until the last failure", "1700",
            [count[last[-1]] if len(last) else 0 for count, last in zip(steps, failed)])
        row("  steps of a run", "3961", [count[-1] for count in steps])


def t_maze(folder, seeds):
    for name, settings in (("with", ()), ("without", WITHOUT_REWARD)):
        tables = runs("t_maze", folder.with_name(f"t_maze_{name}"), seeds, settings)
        for text, part in (("first 5", slice(0, 5)), ("last 20", slice(-20, None))):
            row(f"T-maze {name} reward, success of the {text} (%)", "-",
                [100 * table["success"][part].mean() for table in tables])


def lane(folder, seeds):
    for name, settings in (("with", ()), ("without", ("--set", "reward.function=0; 0"))):
        tables = runs("lane", folder.with_name(f"lane_{name}"), seeds, settings)
        row(f"lane {name} reward, success of the last 10 (%)", "-",
            [100 * table["success"][-10:].mean() for table in tables])


def water_maze(folder, seeds):
    """From seed 101 on: the parameters of the example were chosen on seeds 1 to 4."""
    example = folder.with_name(WATER_MAZE.name)
    shutil.copytree(WATER_MAZE, example, ignore=shutil.ignore_patterns("runs", "*.json"), dirs_exist_ok=True)
    subprocess.run([sys.executable, "make_weights.py"], cwd=example, check=True, stdout=subprocess.DEVNULL)
    for name, settings in (("learning", ()), ("fixed", WITHOUT_LEARNING)):
        tables = sweep(example / "water_maze.yaml", folder.with_name(f"water_maze_{name}"),
                       range(101, 101 + seeds), settings)
        for begin, end in ((1, 5), (6, 10), (11, 20), (21, 30)):
            part = slice(begin - 1, end)
            row(f"water maze, {name} actors, {begin} to {end}: success (%)", "-",
                [100 * table["success"][part].mean() for table in tables])
            row("  median latency (s)", "-", [STEP_S * np.median(table["steps"][part]) for table in tables])


def main():
    tasks = {"mountain_car": mountain_car, "frozen_lake": frozen_lake, "t_maze": t_maze, "lane": lane,
             "water_maze": water_maze}
    parser = argparse.ArgumentParser(description="Learning over many seeds, beside what was published.")
    parser.add_argument("--seeds", type=int, default=20, help="runs of each task (default: 20)")
    parser.add_argument("--out", type=pathlib.Path, help="folder of the sweeps (default: a temporary one)")
    parser.add_argument("tasks", nargs="*", metavar="TASK", help=f"of {', '.join(tasks)} (default: all)")
    given = parser.parse_args()
    for task in given.tasks:
        if task not in tasks:
            parser.error(f"unknown task '{task}'; write some of {', '.join(tasks)}")
    with tempfile.TemporaryDirectory() as temporary:
        out = given.out or pathlib.Path(temporary)
        print(f"{'':<62}{'published':>10}{'median':>10}  (quartiles of {given.seeds} seeds)")
        for task in given.tasks or tasks:
            tasks[task](out / task, given.seeds)
    return 0


if __name__ == "__main__":
    sys.exit(main())
