#!/usr/bin/python3
"""spikeloop sweep: the table, failing runs, stopping and going on; the same runs as by hand."""

import json
import os
import signal
import subprocess
import time
import unittest

import explorer
from recordings import table
from spikeloop.run_folder import RunFolder

FAST = ("--set", "sync=lockstep", "--set", "duration=0.5 s")


def rows_of(folder):
    return table(folder / "results.csv")


class Sweep(explorer.Folder):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "sweep"

    def sweep(self, *words, code=0, **options):
        return explorer.spikeloop("sweep", self.file, *words, "--out", self.out, code=code, **options)

    def test_every_combination_has_a_row_and_is_the_run_by_hand(self):
        out, said = self.sweep(*FAST, "--set", "encoder.rate_max=[100 Hz, 200 Hz]", "--set", "seed=1..3",
                               "--columns", "encoder.spikes,wheels.sent,wheels.sentt")
        self.assertIn("no run has a counter 'wheels.sentt'; did you mean 'wheels.sent'?", said)
        self.assertEqual(out, f"{self.out / 'results.csv'}\n")
        self.assertIn("6 of 6 runs", said)
        self.assertEqual((self.out / "sweep.png").read_bytes()[:4], b"\x89PNG")
        rows = rows_of(self.out)
        self.assertEqual([(row["encoder.rate_max"], row["seed"]) for row in rows],
                         [(rate, seed) for rate in ("100 Hz", "200 Hz") for seed in "123"])
        for row in rows:
            self.assertEqual((row["exit_code"], row["exit_reason"]), ("0", "finished"))
            self.assertGreater(int(row["encoder.spikes"]), 0)
            self.assertGreater(float(row["distance_m"]), 0)
        explorer.spikeloop("run", self.file, "--sync", "lockstep", "--duration", "0.5", "--seed", 2,
                           "--set", "encoder.rate_max=100 Hz", "--out", self.folder / "run")
        self.assertTrue(explorer.same(explorer.spikes_of_run(self.out / "002"), explorer.spikes_of_run(self.folder / "run")))

    def test_counters_of_an_experiment_with_a_script(self):
        self.file = self.with_script()
        _, said = self.sweep(*FAST, "--set", "seed=1..2", "--columns", "encoder.spikes,wheels.sent,wheels.snt", "-q")
        self.assertIn("no run has a counter 'wheels.snt'; did you mean 'wheels.sent'?", said)
        self.assertEqual(said.count("warning"), 1, said)
        for row in rows_of(self.out):
            summary = json.loads((self.out / row["run"] / "summary.json").read_text())
            counters = summary["processes"]["experiment"]["counters"]
            for name in ("encoder.spikes", "wheels.sent"):
                self.assertEqual(int(row[name]), counters[name])
            self.assertEqual(RunFolder(self.out / row["run"]).counters()["wheels.sent"], counters["wheels.sent"])

    def test_runs_that_fail_are_named(self):
        _, said = self.sweep(*FAST, "--set", "encoder.rate_max=[100 Hz, 5 mV, 50 Hz]", code=1)
        explorer.assert_says(said, "run 002 failed: --set encoder.rate_max: key 'rate_max': '5 mV': ... [SL0202]")
        self.assertEqual([row["exit_code"] for row in rows_of(self.out)], ["0", "2", "0"])

    def test_one_that_was_stopped_goes_on(self):
        words = ("--set", "sync=lockstep", "--set", "duration=20 s", "--set", "seed=1..6", "-j", "1")
        with subprocess.Popen([explorer.SPIKELOOP, "sweep", self.file, *words, "--out", self.out],
                              stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as child:
            while not (self.out / "results.csv").exists():
                time.sleep(0.01)
            child.send_signal(signal.SIGTERM)
            said = child.communicate(timeout=60)[1]
        self.assertEqual(child.returncode, 143)
        self.assertIn("the same command goes on from there", said)
        done = len(rows_of(self.out))
        self.assertIn(f"after {done} of 6 runs", said)
        self.assertLess(done, 6)
        # Runs that a busy machine could not end in time were killed, and what watches their programs ends after them.
        patience_until = time.monotonic() + 10
        while left := [line for line in os.popen("ps -eo args") if str(self.out) in line]:
            self.assertLess(time.monotonic(), patience_until, left)
            time.sleep(0.05)
        before = {row["run"]: (self.out / row["run"] / "summary.json").stat().st_mtime_ns for row in rows_of(self.out)}
        self.sweep(*words)
        rows = rows_of(self.out)
        self.assertEqual([row["seed"] for row in rows], [str(seed) for seed in range(1, 7)])
        self.assertEqual({row["exit_code"] for row in rows}, {"0"})
        for run, written in before.items():
            self.assertEqual((self.out / run / "summary.json").stat().st_mtime_ns, written, "it was not run again")

    def test_a_job_of_slurm_does_the_runs(self):
        words = (*FAST, "--set", "encoder.rate_max=[100 Hz, 5 mV, 200 Hz]", "--set", "seed=1..2")
        self.assertEqual(self.sweep(*words, "--slurm")[0], f"{self.out / 'job.sh'}\n")
        job = (self.out / "job.sh").read_text()
        self.assertIn("#SBATCH --array=1-6\n", job)
        self.assertEqual(rows_of(self.out), [])
        for pair, codes in (((1, 2), [0, 0]), ((3, 5), [2, 0]), ((7,), [2])):  # two at once, from a copy, as Slurm does
            tasks = [subprocess.Popen(["bash", "-c", job], env={**os.environ, "SLURM_ARRAY_TASK_ID": str(number)},
                                      cwd="/", stderr=subprocess.DEVNULL) for number in pair]
            self.assertEqual([task.wait(60) for task in tasks], codes)
        (self.out / "006").mkdir()
        (self.out / "006/exit_code").write_text("")  # a task creates the file before it writes the number
        self.sweep(*words, "--slurm")
        self.assertIn("#SBATCH --array=4,6\n", (self.out / "job.sh").read_text())
        before = (self.out / "005" / "summary.json").stat().st_mtime_ns
        self.sweep(*words, code=1)
        self.assertEqual((self.out / "005" / "summary.json").stat().st_mtime_ns, before, "it was not run again")
        rows = rows_of(self.out)
        self.out = self.folder / "here"
        self.sweep(*words, code=1)
        times = ("wall_s", "real_time_factor")
        for row, here in zip(rows, rows_of(self.out), strict=True):
            self.assertEqual({key: row[key] for key in row if key not in times},
                             {key: here[key] for key in here if key not in times})

    def test_random_designs_are_the_same_every_time(self):
        words = (*FAST, "--set", "encoder.rate_max=50 Hz..200 Hz", "--samples", "4")
        self.sweep(*words)
        first = [row["encoder.rate_max"] for row in rows_of(self.out)]
        self.assertEqual(len(set(first)), 4)
        self.assertTrue(all(50 <= float(text.removesuffix(" Hz")) <= 200 for text in first), first)
        self.out = self.folder / "again"
        self.sweep(*words)
        self.assertEqual([row["encoder.rate_max"] for row in rows_of(self.out)], first)

    def test_another_sweep_is_not_mixed_in(self):
        self.sweep(*FAST, "--set", "seed=1..2", "-q")
        for words, text in (((*FAST, "--set", "seed=1..3"), "holds a sweep with other settings"),
                            ((*FAST, "--set", "seed=1..2", "--samples", "2"), "holds a sweep with other --samples")):
            self.assertIn(text, self.sweep(*words, code=2)[1])
        self.file.write_text(self.file.read_text() + "\n")
        self.assertIn("holds a sweep of the file as it was", self.sweep(*FAST, "--set", "seed=1..2", code=2)[1])
        self.out = self.folder / "weights"
        (self.folder / "w.json").write_text(str([[0.001] * 10] * 2))
        words = (*FAST, "--set", "decoder.weights=w.json", "--set", "seed=1..2")
        self.sweep(*words)
        (self.folder / "w.json").write_text(str([[0.002] * 10] * 2))
        self.assertIn("holds a sweep with other contents of the experiment's files", self.sweep(*words, code=2)[1])
        self.out = self.folder
        self.assertIn("is not empty, and holds no sweep", self.sweep("--set", "seed=1..2", code=2)[1])

    def test_a_damaged_table_is_named_and_lost_results_are_run_again(self):
        words = (*FAST, "--set", "seed=1..3")
        self.sweep(*words)
        table = self.out / "results.csv"
        before = rows_of(self.out)
        (self.out / "002" / "summary.json").unlink()
        self.sweep(*words, "--columns", "encoder.spikes")
        rows = rows_of(self.out)
        self.assertEqual([row["distance_m"] for row in rows], [row["distance_m"] for row in before])
        self.assertTrue(all(int(row["encoder.spikes"]) > 0 for row in rows), "of runs that had ended, too")
        table.write_text("\ufeff" + table.read_text())  # as a table program saves it
        self.sweep(*words)
        for damage in ("run;exit_code\n1;0\n", "run,exit_code,exit_reason\nx,0,\n"):
            table.write_text(damage)
            self.assertIn("results.csv' cannot be read", self.sweep(*words, code=4)[1])
        (self.out / "sweep.json").write_text("{")
        self.assertIn("sweep.json' is damaged", self.sweep(*words, code=4)[1])

    def test_two_at_once_are_refused(self):
        words = ("--set", "sync=lockstep", "--set", "duration=20 s", "--set", "seed=1..20", "-j", "1")
        with subprocess.Popen([explorer.SPIKELOOP, "sweep", self.file, *words, "--out", self.out],
                              stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL) as child:
            while not (self.out / "001").exists():
                time.sleep(0.01)
            self.assertIn("another sweep that has not ended writes to", self.sweep(*words, code=4)[1])
            child.send_signal(signal.SIGINT)
            child.wait(60)

    def test_mistakes(self):
        for setting, text in (("seed=5..1", "the range is empty"), ("encoder.rate_max=1 Hz..5 Hz", "needs a step"),
                           ("seed", "expected KEY=VALUES"), ("encodr.tau=1", "'encodr'; ... 'encoder'? ... [SL0301]")):
            explorer.refused(text, "sweep", self.file, "--set", setting, "--out", self.out)
            self.assertFalse(self.out.exists())
        explorer.refused("'no.yaml'", "sweep", "no.yaml", "--set", "seed=1..2", "--out", self.out, code=4)


if __name__ == "__main__":
    unittest.main()
