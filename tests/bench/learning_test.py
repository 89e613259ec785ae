#!/usr/bin/python3
"""`spikeloop bench --learning`: its table against the episodes of its runs; a second call measures nothing again."""

import csv
import pathlib
import statistics
import sys
import tempfile
import unittest

from bench_program import bench


def last_failure(folder):
    """Steps until the end of the last episode without success, and of all episodes."""
    with open(folder / "episodes.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    steps, last = 0, 0
    for row in rows:
        steps += int(row["steps"])
        last = last if row["success"] == "1" else steps
    return last, steps


class Learning(unittest.TestCase):
    def test_table(self):
        with tempfile.TemporaryDirectory() as temporary:
            words = ("--learning", "--tasks", "frozen_lake", "--seeds", "2", "--out", "lakes")
            out, _ = bench(*words, folder=temporary)
            lines = out.splitlines()
            self.assertEqual(lines[0].split(), ["published", "median", "(quartiles", "of", "2", "seeds)"])
            self.assertEqual(len(lines), 5)
            folder = pathlib.Path(temporary) / "lakes"
            for name, (failed, steps) in (("frozen_lake_published", lines[1:3]), ("frozen_lake", lines[3:5])):
                found = [last_failure(folder / name / run) for run in ("001", "002")]
                for line, published, values in zip((failed, steps), ("1700", "3961"), zip(*found)):
                    self.assertIn(f"{published}{statistics.median(values):>10.4g}  (", line)
            runs = {path: path.stat().st_mtime_ns for path in folder.glob("*/*/summary.json")}
            self.assertEqual(len(runs), 4)
            self.assertEqual(bench(*words, folder=temporary)[0], out)
            self.assertEqual({path: path.stat().st_mtime_ns for path in runs}, runs)

    def test_a_folder_that_cannot_be(self):
        _, error = bench("--learning", "--out", "/proc/none", code=4)
        self.assertIn("cannot write '/proc/none/mountain_car.yaml'", error)


if __name__ == "__main__":
    sys.exit(unittest.main())
