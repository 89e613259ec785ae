"""`spikeloop sweep`: one experiment with many settings. Its options are explained in C++
(sweep_command.cpp).

A sweep's folder holds sweep.json (the experiment and its settings), the run folders 001, 002, ...,
results.csv, a row for every run that has ended, and at the end sweep.png. The same command goes on
where it was stopped. With --slurm it holds job.sh, too, whose tasks do the runs.
"""

import argparse
import csv
import fcntl
import hashlib
import io
import json
import os
import pathlib
import shlex
import subprocess
import sys
import time

from .design import DesignError, design
from .experiment import SpikeloopError, call, program, setting_words, suspending
from .progress import Progress, Stopped, end_process, note_signals
from .run_folder import complete_lines, counters_of, did_you_mean
from .summary import ROWS
from .whole_file import create, write_whole

EXIT_FAILED, EXIT_USAGE, EXIT_FILE = 1, 2, 4
STATE = "sweep.json"
TABLE = "results.csv"
MEASURED = tuple(key for key, *_ in ROWS)  # a run has those that it measured
EXIT_CODE = "exit_code"  # in the folder of a run that a task of a job has done
END_S = 10
# `set` gives a task the name of its folder, and the settings of its run. A run that was killed leaves no exit code.
JOB = """\
#!/bin/bash
#SBATCH --job-name={name}
#SBATCH --array={tasks}
#SBATCH --output=/dev/null
# Task N does run N of a sweep. When the job has ended, spikeloop sweep makes the table.
cd {folder} || exit 4
case $SLURM_ARRAY_TASK_ID in
{cases}
*) echo "job.sh has no run '$SLURM_ARRAY_TASK_ID'; start it by  sbatch job.sh" >&2; exit 2 ;;
esac
run=$1
shift
mkdir -p "$run" && rm -f "$run/{exit_code}" "$run/stderr.txt" || exit 4
{program} run -q --out "$run" --force "$@" -- {file} > /dev/null 2> "$run/stderr.txt"
code=$?
echo $code > "$run/{exit_code}"
exit $code
"""


class SweepError(Exception):
    """The sweep cannot begin; the text says why, and what to write."""

    def __init__(self, message, code=EXIT_USAGE):
        super().__init__(message)
        self.code = code


class Sweep:
    """The runs of one experiment, in a folder."""

    def __init__(self, file, settings, samples, folder, columns):
        self.columns = columns
        self.file, self.folder = pathlib.Path(file), pathlib.Path(folder)
        self.runs = design(settings, samples)
        self._digits = max(3, len(str(len(self.runs))))
        self._state = {"experiment": str(self.file.absolute()), "settings": settings, "samples": samples,
                       "sha256": hashlib.sha256(self.file.read_bytes()).hexdigest()}
        self.rows = {}  # of results.csv, by number
        self.counters = set()  # that runs have had

    def name(self, number):
        """Of the run's folder: "007"; numbers count from 1."""
        return f"{number:0{self._digits}}"

    def varied(self):
        """Keys that have several values."""
        return [key for key in self.runs[0] if len({run[key] for run in self.runs}) > 1]

    def missing(self):
        """Numbers of the runs that have no row."""
        return [number for number in range(1, len(self.runs) + 1) if number not in self.rows]

    def open(self, files):
        """Makes the folder, or goes on in it. files: fingerprints of what the experiment reads. @raises SweepError"""
        self._state["files"] = files
        state = self.folder / STATE
        if self.folder.exists() and not state.exists() and any(self.folder.iterdir()):
            raise SweepError(f"--out: '{self.folder}' is not empty, and holds no sweep; write another folder")
        self.folder.mkdir(parents=True, exist_ok=True)
        self._lock = os.open(self.folder, os.O_RDONLY)  # until this process ends
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise SweepError(f"--out: another sweep that has not ended writes to '{self.folder}'; wait for its end, "
                             "or write another folder", EXIT_FILE) from None
        if not state.exists():
            write_whole(state, json.dumps(self._state, indent=1) + "\n")
            return
        try:
            before = dict(json.loads(state.read_text(encoding="utf-8")))
        except ValueError as error:
            raise SweepError(f"'{state}' is damaged: {error}; write another folder", EXIT_FILE) from None
        for key, what in (("experiment", "of another experiment"), ("settings", "with other settings"),
                          ("samples", "with other --samples"), ("sha256", "of the file as it was"),
                          ("files", "with other contents of the experiment's files")):
            if before.get(key) != self._state[key]:
                raise SweepError(f"--out: '{self.folder}' holds a sweep {what}; write another folder, or remove it")
        self._read_table()
        self._read_tasks()

    def _read_table(self):
        """The rows of runs that have ended; their results are read again."""
        path = self.folder / TABLE
        if not path.exists():
            return
        try:
            with open(path, newline="", encoding="utf-8-sig") as table:
                rows = [(int(row["run"]), int(row["exit_code"]), row["exit_reason"] or "")
                        for row in csv.DictReader(table)]
        except (ValueError, KeyError, TypeError, csv.Error) as error:
            raise SweepError(f"'{path}' cannot be read: {error}; remove it, and all runs are repeated",
                             EXIT_FILE) from None
        for number, exit_code, reason in rows:
            if 1 <= number <= len(self.runs):
                self.take(number, exit_code, reason)

    def _read_tasks(self):
        """What tasks of job.sh have done since."""
        for number in self.missing():
            code = self.folder / self.name(number) / EXIT_CODE
            if code.exists() and (lines := complete_lines(code)):  # else the task is writing it
                exit_code, errors = int(lines[0]), code.parent / "stderr.txt"
                said = errors.read_text(encoding="utf-8")
                if exit_code < 128:  # else it was stopped by a signal, and runs again
                    self.take(number, exit_code, said)
                if not said:
                    errors.unlink()
                code.unlink()  # from now on the table has it

    def write_job(self):
        """job.sh: a job array of Slurm's with a task for every run that is missing; returns its path."""
        numbers = self.missing()
        cases = [f"{number}) set -- {shlex.join([self.name(number), *setting_words(self.runs[number - 1], str)])} ;;"
                 for number in numbers]
        tasks = f"1-{len(numbers)}" if len(numbers) == len(self.runs) else ",".join(map(str, numbers))
        path = self.folder / "job.sh"
        write_whole(path, JOB.format(
            name=shlex.quote(self.folder.name), tasks=tasks, cases="\n".join(cases), exit_code=EXIT_CODE,
            folder=shlex.quote(str(self.folder.absolute())), program=shlex.quote(str(program())),
            file=shlex.quote(self._state["experiment"])))
        return path

    def write_table(self):
        """results.csv: run, settings, exit code and reason, what the summaries have."""
        keys = list(self.runs[0])
        measured = [key for key in MEASURED if any(row.get(key) not in (None, "") for row in self.rows.values())]
        extra = sorted({key for row in self.rows.values() for key in row} - {"run", "exit_code", "exit_reason"}
                       - set(keys) - set(MEASURED))
        text = io.StringIO()
        table = csv.DictWriter(text, ["run", *keys, "exit_code", "exit_reason", *measured, *extra],
                               extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        for number in sorted(self.rows):
            table.writerow(self.rows[number])
        write_whole(self.folder / TABLE, text.getvalue())

    def take(self, number, exit_code, said):
        """Notes how a run ended, and its results."""
        row = {"run": self.name(number), **self.runs[number - 1]}
        try:
            summary = dict(json.loads((self.folder / self.name(number) / "summary.json").read_text(encoding="utf-8")))
        except (OSError, ValueError):
            summary = {}
            if exit_code == 0:
                return  # whatever the table says, it has no results: it runs again
        row.update({key: str(summary[key]) for key in MEASURED if summary.get(key) is not None})
        counters = counters_of(summary)
        self.counters.update(counters)
        row.update({name: str(counters[name]) for name in self.columns if name in counters})
        lines = said.strip().splitlines()
        row["exit_code"] = str(exit_code)
        row["exit_reason"] = "finished" if exit_code == 0 else \
            (lines[-1].removeprefix("spikeloop: ") if lines else f"exit code {exit_code}")
        self.rows[number] = row

    def failed(self):
        """Their rows."""
        return [row for _, row in sorted(self.rows.items()) if row["exit_code"] != "0"]


class Worker:
    """A run that is under way."""

    def __init__(self, sweep, number):
        self.number, self.began = number, time.monotonic()
        folder = sweep.folder / sweep.name(number)
        folder.mkdir(exist_ok=True)
        self._said = create(folder / "stderr.txt", "x+", encoding="utf-8")
        self.process = subprocess.Popen(
            [program(), "run", "-q", "--out", str(folder), "--force",
             *setting_words(sweep.runs[number - 1], str), "--", str(sweep.file)],
            stdout=subprocess.DEVNULL, stderr=self._said, stdin=subprocess.DEVNULL, start_new_session=True)

    def stop(self):
        end_process(self.process, END_S)
        self._said.close()

    def said(self):
        """What it printed; its file is kept only when there is something in it."""
        self._said.seek(0)
        text = self._said.read()
        path = pathlib.Path(self._said.name)
        self._said.close()
        if not text:
            path.unlink()
        return text


def time_text(seconds):
    """"2 h 05 min", "3 min", "40 s"."""
    if seconds >= 3600:
        return f"{int(seconds / 3600)} h {int(seconds % 3600 / 60):02} min"
    return f"{round(seconds / 60)} min" if seconds >= 100 else f"{round(seconds)} s"


class Sweeping:
    """The work: up to `jobs` runs at once."""

    def __init__(self, sweep, jobs, progress):
        self._sweep, self._jobs, self._progress = sweep, jobs, progress
        self._open = sweep.missing()
        self._all = len(self._open)
        self._ended = 0
        self._began = self._told = time.monotonic()
        self.running = []

    def run(self, signals):
        """@raises Stopped: a signal is in the list"""
        with suspending(lambda: [worker.process for worker in self.running]):
            while self._open or self.running:
                if signals:
                    raise Stopped(signals[0])
                self._turn()

    def _turn(self):
        while self._open and len(self.running) < self._jobs:
            self.running.append(Worker(self._sweep, self._open.pop(0)))
        done = [worker for worker in self.running if worker.process.poll() is not None]
        for worker in done:
            self.running.remove(worker)
            self._end(worker)
        if done:
            self._say()
        else:
            time.sleep(0.01)

    def _end(self, worker):
        exit_code, said = worker.process.returncode, worker.said()
        self._sweep.take(worker.number, exit_code, said)
        if worker.number not in self._sweep.rows:
            self._sweep.take(worker.number, EXIT_FILE, "there is no summary.json in its folder")
        self._ended += 1

    def _say(self):
        """At most once a second, and at the end."""
        now = time.monotonic()
        if now - self._told < 1 and self._ended < self._all:
            return
        self._told = now
        self._sweep.write_table()
        left = (now - self._began) / self._ended * (self._all - self._ended)
        bad = len(self._sweep.failed())
        failed = f", {bad} failed" if bad else ""
        rest = f", about {time_text(left)} left" if self._ended < self._all else ""
        self._progress.say(f"{len(self._sweep.rows)} of {len(self._sweep.runs)} runs{failed}{rest}")

    def stop(self):
        for worker in self.running:
            worker.stop()


def _arguments(arguments):
    parser = argparse.ArgumentParser(prog="spikeloop sweep")
    parser.add_argument("file")
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--samples", type=int)
    parser.add_argument("--jobs", type=int)
    parser.add_argument("--columns", type=lambda text: text.split(","), default=[])
    parser.add_argument("--out", required=True)
    parser.add_argument("--slurm", action="store_true")
    parser.add_argument("--quiet", action="store_true")
    return parser.parse_args(arguments)


def _report(sweep):
    failed = sweep.failed()
    for row in failed[:20]:
        print(f"spikeloop: run {row['run']} failed: {row['exit_reason']}", file=sys.stderr)
    if len(failed) > 20:
        print(f"spikeloop: and {len(failed) - 20} more", file=sys.stderr)
    return EXIT_FAILED if failed else 0


def _jobs(given, sweep, sync):
    """Runs that follow the wall clock would disturb each other."""
    all_of_them = {run.get("sync", sync) for run in sweep.runs}
    return given.jobs or (len(os.sched_getaffinity(0)) if all_of_them <= {"lockstep", "unpaced"} else 1)


def is_seed(key):
    """Whether a key's values differ by chance alone: "seed", "robot.seed"."""
    return key.split(".")[-1] == "seed"


def _draw(sweep):
    """sweep.png and episodes.png, if there is something to see: `spikeloop plot FOLDER` says why there is not."""
    folder = sweep.folder
    if all(map(is_seed, sweep.varied())) and not any(folder.glob("*/episodes.csv")):
        return  # and half a second for importing matplotlib is saved
    try:
        from .plots import plot_run
        plot_run(folder)
    except ImportError as error:
        print(f"spikeloop: {folder / 'sweep.png'} is not drawn: Python's package {error.name} is missing; "
              f"apt-get install python3-{error.name}", file=sys.stderr)


def _sweep(given):
    signals = note_signals()
    sweep = Sweep(given.file, given.set, given.samples, given.out, given.columns)
    checked = json.loads(call("check", "--json", *setting_words(sweep.runs[0]), "--", given.file))
    sweep.open(checked["files"])
    if given.slurm:
        sweep.write_table()
        print(sweep.write_job())
        return 0
    progress = Progress(open(os.devnull, "w", encoding="utf-8") if given.quiet else sys.stderr)
    progress.part = str(sweep.folder)
    work = Sweeping(sweep, _jobs(given, sweep, checked["sync"]), progress)
    stopped = None
    try:
        work.run(signals)
    except Stopped as stop:
        stopped = stop
    finally:
        work.stop()
        progress.end()
        sweep.write_table()
    if stopped is not None:
        print(f"spikeloop: stopped by {stopped} after {len(sweep.rows)} of {len(sweep.runs)} runs; the same command "
              "goes on from there", file=sys.stderr)
        return 128 + stopped.number
    for name in given.columns:
        if sweep.counters and name not in sweep.counters:
            print(f"spikeloop: warning: --columns: no run has a counter '{name}'"
                  f"{did_you_mean(name, sorted(sweep.counters))}", file=sys.stderr)
    print(sweep.folder / TABLE)
    _draw(sweep)
    return _report(sweep)


def main(arguments=None):
    try:
        return _sweep(_arguments(arguments))
    except (SweepError, SpikeloopError) as error:
        code = error.code if isinstance(error, SweepError) else error.exit_code
        print(f"spikeloop: {error}", file=sys.stderr)
        return code
    except DesignError as error:
        print(f"spikeloop: {error}", file=sys.stderr)
        return EXIT_USAGE
    except OSError as error:
        print(f"spikeloop: '{error.filename}': {error.strerror}", file=sys.stderr)
        return EXIT_FILE


if __name__ == "__main__":
    sys.exit(main())
