#!/usr/bin/python3
"""Mistakes on the command line, word by word, and help and completion."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

from bench_program import SPIKELOOP, assert_says, bench

WRONG = (
    (("--part", "e"), "--part: unknown part 'e'; write some of a,b,c,d"),
    (("--part", "a,"), "--part: unknown part ''; write some of a,b,c,d"),
    (("--layouts", "fussed"), "--layouts: unknown layout 'fussed'; did you mean 'fused'?"),
    (("--simulators", "none,brian"),
     "--simulators: unknown simulator 'brian'; did you mean 'brian2'?"),
    (("--encoders", "linear"), "--encoders: unknown encoder 'linear'; write some of rate,poisson,nef"),
    (("--trials", "0"),
     "--trials: '0' cannot be; write a whole number from 1 to 1000, as in --trials 5"),
    (("--trials", "2.5"), "--trials: '2.5' ... 1 ... 1000, ... --trials 5"),
    (("--steps", "many"), "--steps: 'many' ... 1 ... 100000, ... --steps 5"),
    (("--neurons", "-1"), "--neurons: '-1' ... 1 ... 16777216, ... --neurons 5"),
    (("--most", "20000000"), "--most: '20000000' ... 1 ... 16777216, ... --most 5"),
    (("--ticks", "1,0"),
     "--ticks: '0' cannot be; write ms from 0.1 to 1000, divided by commas, as in --ticks 1,10,50"),
    (("--rates", "1;2"),
     "--rates: '1;2' cannot be; write Hz from 0.1 to 10000, divided by commas, as in --rates "
     "1,40,800"),
    (("--duration", "0"),
     "--duration: '0' cannot be; write the simulated seconds of a run, at least 0.05, as in "
     "--duration 10"),
    (("--limit", "10 mV"),
     "--limit: '10 mV' cannot be; write the wall seconds that a run may take, at least 0.05, as in "
     "--limit 30"),
    (("--learning", "--tasks", "lanes"), "--tasks: unknown task 'lanes'; did you mean 'lane'?"),
    (("--learning", "--seeds", "0"), "--seeds: '0' ... 1 ... 10000, ... --seeds 5"),
    (("--learning", "--ticks", "1"), "--ticks excludes --learning; see spikeloop bench --help"),
    (("--seeds", "3"), "--seeds requires --learning; see spikeloop bench --help"),
    (("--qiuck",), "unknown option '--qiuck'; did you mean '--quick'?"),
)


class Options(unittest.TestCase):
    def test_mistakes(self):
        for arguments, said in WRONG:
            with self.subTest(arguments=arguments):
                out, error = bench(*arguments, code=2)
                self.assertEqual((out, error.count("\n")), ("", 1), error)
                assert_says(error, f"spikeloop: {said}")

    def test_ticks_that_are_no_part_of_the_duration(self):
        with tempfile.TemporaryDirectory() as folder:
            _, error = bench("--ticks", "3", "--duration", "10", "--out", f"{folder}/x", code=2)
            self.assertEqual(error, "spikeloop: --duration 10 is not a whole number of ticks of 3 ms; write "
                                    "another duration, or --ticks that divide it\n")
            _, error = bench("--duration", "0.06", "--part", "a", "--out", f"{folder}/x", code=2)
            assert_says(error, "spikeloop: --duration 0.06 ... 50 ms; ... --ticks ")
            self.assertFalse(pathlib.Path(f"{folder}/x").exists())

    def test_folders(self):
        with tempfile.TemporaryDirectory() as folder:
            _, error = bench("--draw", "--out", f"{folder}/x", code=4)
            self.assertEqual(error, f"spikeloop: '{folder}/x/results.json' has no results to draw; leave "
                                    "out --draw\n")
            _, error = bench("--out", "/proc/none", code=4)
            assert_says(error, "spikeloop: cannot make '/proc/none': ")
            (pathlib.Path(folder) / "results.json").write_text("{}")
            _, error = bench("--draw", "--out", folder, code=4)
            assert_says(error, f"'{folder}/results.json' ... 'duration_s'; ")
            _, error = bench("--out", "", code=2)
            self.assertIn("the name of the folder is empty; write one", error)

    def test_missing_python_and_packages(self):
        _, error = bench(code=3, PYTHON="/nowhere/python3")
        self.assertEqual(error, "spikeloop: there is no python3, which measures and draws; apt-get "
                                "install python3-matplotlib python3-h5py, or set PYTHON to one that "
                                "has them\n")
        with tempfile.TemporaryDirectory() as folder:
            for package in ("h5py", "matplotlib"):
                fake = pathlib.Path(folder) / package / package
                fake.mkdir(parents=True)
                (fake / "__init__.py").write_text(f"raise ModuleNotFoundError('gone', name='{package}')")
                _, error = bench(code=3, PYTHONPATH=str(fake.parent))
                self.assertEqual(error, f"spikeloop: Python's package {package} is missing, or of no use "
                                        f"(gone); apt-get install python3-{package}\n")

    def test_help(self):
        said, _ = bench("--help")
        for text in ("Weidel, Djurfeldt, Duarte & Morrison 2016", "spikeloop bench --quick",
                     "--layouts LIST:{fused,separate}", "Exit codes: 0 measured"):
            self.assertIn(text, said)
        self.assertIn("Two minutes at most, with few points; other defaults: --simulators none, "
                      "--ticks 1,50, --rates 40,800, --trials 1, --steps 3, --most 1000000, "
                      "--duration 1 s", " ".join(said.split()))

    def test_completion(self):
        script = ("source <(\"$0\" completion bash); COMP_WORDS=(spikeloop bench \"$@\"); "
                  "COMP_CWORD=$(($# + 1)); _spikeloop; printf '%s\\n' \"${COMPREPLY[@]}\"")
        for words, suggested in ((("--simulators", "b"), {"builtin", "brian2"}),
                                 (("--qu",), {"--quick"}), (("--part", ""), {"a", "b", "c", "d"})):
            done = subprocess.run(["bash", "--norc", "-c", script, SPIKELOOP, *words], text=True,
                                  capture_output=True, check=True, env={**os.environ})
            self.assertEqual(set(done.stdout.split()), suggested, words)


if __name__ == "__main__":
    sys.exit(unittest.main())
