#!/usr/bin/python3
"""Measures the time from a fault to the zero command with an independent subscriber of /cmd_vel: rospy over ROS 1,
Fast DDS over ROS 2. The subscriber also sends scans at 50 Hz.

Every fault of faults.py has a run of its own. The robot must be at rest within the time of the fault, and stay at rest
until the run continues; the run must report why it ends, and leave nothing behind. A fault that breaks a rule is
repeated twice, and the median run counts, because a busy machine may delay one of three; but a run in which the robot
is driven on always counts. The script ends with 1 if a fault breaks a rule.

  time_to_zero.py --layout fused --ros 1 --fault guard       all faults of the guard
  time_to_zero.py --representative                           one fault per mechanism
  time_to_zero.py --page docs/safety.md                      all faults; writes the tables of the page
"""

import argparse
import dataclasses
import json
import pathlib
import subprocess
import sys
import tempfile
import threading
import time

import cells
import faults
import pages
import robots
from loop import LAYOUTS, PROGRAMS


def measured(fault, layout, version, robot, repetitions):
    """The run that counts."""
    runs = [cells.measure(fault, layout, version, robot) for _ in range(repetitions)]
    if repetitions == 1 and runs[0].complaints:
        runs += [cells.measure(fault, layout, version, robot) for _ in range(2)]
    return cells.that_counts(runs)


def run_group(version, layout, chosen, arguments):
    """Measures the faults of one layout over one version of ROS; appends them to the file of results."""
    with tempfile.TemporaryDirectory() as scratch, robots.robot(version, PROGRAMS, pathlib.Path(scratch)) as robot:
        for number, fault in enumerate(chosen, 1):
            cell = measured(fault, layout, version, robot, arguments.repetitions)
            with open(arguments.results, "a", encoding="utf-8") as results:
                results.write(json.dumps(dataclasses.asdict(cell)) + "\n")
            print(f"ROS {version}, {layout}, {number} of {len(chosen)}: {fault.name}: {pages.line(cell)}", flush=True)


def chosen_faults(arguments, layout):
    return [fault for fault in faults.FAULTS if layout in fault.layouts
            and (not arguments.fault or any(text in fault.name for text in arguments.fault))
            and (not arguments.representative or faults.is_representative(fault, layout))]


def run_groups(groups, arguments):
    """Starts a process for each group, because rospy starts only once in a process."""
    waiting = list(groups)

    def work():
        while waiting:
            version, layout = waiting.pop(0)
            words = ["--ros", version, "--layout", layout, "--repetitions", str(arguments.repetitions),
                     "--results", arguments.results, "--no-table"]
            words += [word for text in arguments.fault or [] for word in ("--fault", text)]
            words += ["--representative"] * arguments.representative
            subprocess.run([sys.executable, "-B", __file__, *words], check=False)

    workers = [threading.Thread(target=work) for _ in range(arguments.parallel)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()


def read_results(path):
    """Cells by key; the newest one counts."""
    lines = pathlib.Path(path).read_text(encoding="utf-8").splitlines()
    return {cell.key: cell for cell in (cells.Cell(**json.loads(line)) for line in lines)}


def show(results, page, minutes):
    """Prints the tables and every cell that breaks a rule. Writes the page if a path is given."""
    bad = [cell for cell in results.values() if cell.complaints]
    print(pages.tables(results))
    for cell in bad:
        print(f"ROS {cell.ros}, {cell.layout}, {cell.fault}: {pages.line(cell)}")
    print(f"{len(results)} cells, {len(bad)} break a rule; measured within {minutes:.1f} min")
    if page:
        pages.write(pathlib.Path(page), results)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repetitions", type=int, default=1)
    parser.add_argument("--layout", choices=LAYOUTS, action="append")
    parser.add_argument("--ros", choices=["1", "2"], action="append")
    parser.add_argument("--fault", action="append", help="only faults whose names contain this text; repeatable")
    parser.add_argument("--representative", action="store_true", help="one fault per mechanism")
    parser.add_argument("--parallel", type=int, default=1, help="number of runs at the same time")
    parser.add_argument("--results", help="file of JSON lines to append to; the tables show all results in it")
    parser.add_argument("--page", help="page whose tables are replaced if there is a result for every fault")
    parser.add_argument("--no-table", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    begin = time.monotonic()
    groups = [(version, layout) for version in arguments.ros or ["1", "2"] for layout in arguments.layout or LAYOUTS]
    wanted = {(fault.name, layout, version) for version, layout in groups for fault in chosen_faults(arguments, layout)}
    with tempfile.TemporaryDirectory() as scratch:
        arguments.results = arguments.results or f"{scratch}/results"
        pathlib.Path(arguments.results).touch()
        if len(groups) > 1:
            run_groups(groups, arguments)
        else:
            run_group(*groups[0], chosen_faults(arguments, groups[0][1]), arguments)
        results = read_results(arguments.results)
    if not arguments.no_table:
        show(results, arguments.page, (time.monotonic() - begin) / 60)
    assert wanted <= results.keys(), f"not measured: {sorted(wanted - results.keys())}"
    return 1 if any(results[key].complaints for key in wanted) else 0


if __name__ == "__main__":
    sys.exit(main())
