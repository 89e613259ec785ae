"""results.json: everything that was measured, written after every run, so that nothing is lost."""

import datetime
import json
import os
import platform
import statistics

from . import entries
from ..whole_file import write_whole

NAME = "results.json"
FORMAT = 1


class ResultsError(Exception):
    """What is in the way, and what to do; with the exit code."""

    def __init__(self, message, code=4):
        super().__init__(message)
        self.code = code


def machine():
    """What the figures hold for."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    except OSError:
        names = []
    return {"cpu": names[0] if names else platform.machine(), "cores": len(os.sched_getaffinity(0)),
            "kernel": platform.release()}


class Results:
    """What is known, by the keys of a point; `keep` writes it."""

    def __init__(self, folder, notes):
        """notes: what else is written down (protocol, the paper's values)."""
        self.path = folder / NAME
        self.points, self.latencies, self.largest, self.not_measured = [], [], [], []
        self._notes = {"machine": machine(), **notes}
        self._known = self._read()
        self._measured = False

    def _read(self):
        try:
            known = json.loads(self.path.read_text(encoding="utf-8"))
            if known.get("format", 0) > FORMAT:
                raise ResultsError(f"'{self.path}' was written by a newer Spikeloop; write another "
                                   "folder with --out")
            entries.check(known)
            for name in ("points", "latencies", "largest", "not_measured"):
                getattr(self, name).extend(known[name])
            return known
        except FileNotFoundError:
            return {}
        except OSError as error:
            raise ResultsError(f"cannot read '{self.path}': {error.strerror}") from None
        except entries.EntryError as error:
            raise ResultsError(f"'{self.path}' is not what spikeloop bench writes: {error}; move it "
                               "away, or write another folder with --out") from None
        except (ValueError, AttributeError, TypeError):
            raise ResultsError(f"'{self.path}' is not what spikeloop bench writes; move it away, or "
                               "write another folder with --out") from None

    @property
    def empty(self):
        return not (self.points or self.latencies)

    def refuse_other_machine(self):
        """Figures of two machines in one table would be worth nothing."""
        was, now = self._known.get("machine", {}), self._notes["machine"]
        for key in ("cpu", "cores"):
            if self.points + self.latencies and was.get(key, now[key]) != now[key]:
                raise ResultsError(f"'{self.path}' was measured on another machine ({key}: "
                                   f"{was[key]}, here {now[key]}); write another folder with --out, or "
                                   "--draw to look at it", 2)

    def document(self):
        """What the file has: the notes are those of who measured."""
        notes = self._notes if self._measured or not self._known else self._known
        return {**notes, "format": FORMAT, "points": self.points, "largest": self.largest,
                "latencies": self.latencies, "not_measured": self.not_measured}

    def keep(self):
        """Writes the file, whole or not at all."""
        self._measured = True
        whole = {**self.document(), "written": datetime.datetime.now(datetime.timezone.utc).isoformat(
            "T", "seconds")}
        try:
            write_whole(self.path, json.dumps(whole, indent=1) + "\n")
        except OSError as error:
            raise ResultsError(f"cannot write '{self.path}': {error.strerror}") from None

    def point(self, keys):
        """The entry with these keys, which is made when there is none."""
        return _entry(self.points, keys, {"trials": [], "real_time_factor": None})

    def add_trial(self, point, trial):
        point["trials"].append(trial)
        point["real_time_factor"] = statistics.median(
            one["real_time_factor"] for one in point["trials"])
        self.keep()

    def set_largest(self, keys, found):
        """found: search.Found."""
        entry = _entry(self.largest, keys, {})
        entry.update(neurons=found.neurons, next=found.next)
        self.keep()

    def add_latency(self, keys, row):
        _entry(self.latencies, keys, {}).update(row)
        self.keep()

    def lacks(self, keys, reason, failed=True):
        """That something was not measured, and why; `failed`: though it should have been."""
        _entry(self.not_measured, keys, {}).update(reason=reason, failed=failed)
        self.keep()

    def settle(self, keys):
        """Forgets why these were not measured: they are tried again."""
        self.not_measured[:] = [entry for entry in self.not_measured if not _fits(entry, keys)]


def _fits(entry, keys):
    return all(entry.get(name) == value for name, value in keys.items())


def _entry(entries, keys, otherwise):
    for entry in entries:
        if _fits(entry, keys):
            return entry
    entries.append({**keys, **otherwise})
    return entries[-1]
