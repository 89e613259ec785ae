#!/usr/bin/python3
"""A tiny bench from end to end, what it leaves, and that it goes on where it was."""

import sys
import unittest

from bench_program import FolderCase, assert_says, bench, results

TINY = ("--duration", "1", "--trials", "1", "--neurons", "100", "--rates", "5,80",
        "--ticks", "50,10", "--steps", "2", "--limit", "60")  # a busy machine ends its runs, too
# Every number of neurons in a curve is a run, or several where one is too slow.
ALL = (*TINY, "--simulators", "none,builtin", "--most", "100")
PNG = b"\x89PNG\r\n\x1a\n"


class Program(FolderCase):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out"

    def test_all_parts(self):
        said, progress = bench(*ALL, "--out", self.out)
        found = results(self.out)
        curves = {(point["layout"], point["encoder"], point["simulator"], point["tick_ms"])
                  for point in found["points"]}
        for layout in ("fused", "separate"):
            for encoder in ("rate", "poisson", "nef"):
                for simulator in ("none", "builtin"):
                    self.assertIn((layout, encoder, simulator, 50), curves)
            self.assertIn((layout, "rate", "none", 10), curves)
            self.assertIn(f"rate of 100 neurons in real time, {layout}", said)
        for point in found["points"]:
            self.assertEqual(len(point["trials"]), 1, point)
            self.assertGreater(point["trials"][0]["spikes"], 0, point)
        self.assertEqual({row["tick_ms"] for row in found["latencies"]}, {10, 50})
        for row in found["latencies"]:
            self.assertGreater(row["median_ms"], 0)
        self.assertEqual(found["not_measured"], [])
        self.assertEqual(found["paper"]["neurons_in_real_time"],
                         {"rate": 150_000, "poisson": 150_000, "nef": 20_000})
        for part in "abcd":
            picture = self.out / f"{part}.png"
            self.assertEqual(picture.read_bytes()[:8], PNG)
            self.assertIn(str(picture), said.splitlines())
            self.assertIn(f"spikeloop: {part}: ", progress)
        self.drawn_again(said)

    def drawn_again(self, said):
        """Nothing that is known is measured again."""
        for picture in self.out.glob("*.png"):
            picture.unlink()
        self.assertEqual(bench(*ALL, "--out", self.out), (said, ""))
        self.assertEqual(len(list(self.out.glob("*.png"))), 4)

    def test_parts_one_after_the_other_and_more_trials(self):
        tiny = (*TINY, "--most", "2000", "--layouts", "fused", "--encoders", "rate", "--simulators", "none")
        said, _ = bench(*tiny, "--part", "b", "--out", self.out)
        self.assertEqual([path.name for path in self.out.glob("*.png")], ["b.png"])
        (self.out / "b.png").unlink()
        self.assertEqual(bench("--draw", "--out", self.out), (said, ""))  # measures nothing
        self.assertEqual([path.name for path in self.out.glob("*.png")], ["b.png"])
        before = results(self.out)["points"]
        more = tuple("2" if tiny[i - 1] == "--trials" else word for i, word in enumerate(tiny))
        bench(*more, "--part", "a,b", "--out", self.out)
        self.assertEqual({path.name for path in self.out.glob("*.png")}, {"a.png", "b.png"})
        for point in before:
            now = next(other for other in results(self.out)["points"]
                       if (other["neurons"], other["rate_max_hz"])
                       == (point["neurons"], point["rate_max_hz"]))
            self.assertEqual(len(now["trials"]), 2)
            self.assertEqual(now["trials"][0], point["trials"][0])
        bench(*tiny, "--part", "b", "--again", "--out", self.out)
        for point in results(self.out)["points"]:
            if point["rate_min_hz"] == point["rate_max_hz"]:
                self.assertEqual(len(point["trials"]), 1)

    def test_quick(self):
        said, _ = bench("--quick", "--part", "a,b", "--encoders", "rate", "--layouts", "fused",
                        folder=self.folder)
        found = results(self.folder / "bench-quick")
        self.assertEqual(found["duration_s"], 1)
        self.assertEqual({point["simulator"] for point in found["points"]}, {"none"})
        self.assertIn("bench-quick/b.png", said.splitlines())

    def test_what_is_written_beside_quick_counts(self):
        bench("--quick", "--part", "a,b", "--encoders", "rate", "--layouts", "fused", "--simulators",
              "builtin", "--rates", "5,80", "--trials", "2", "--duration", "2", "--neurons", "100",
              "--most", "1000", "--out", self.out)
        found = results(self.out)
        self.assertEqual(found["duration_s"], 2)
        of_b = [point for point in found["points"] if point["rate_min_hz"] == point["rate_max_hz"]]
        self.assertEqual([(point["rate_max_hz"], len(point["trials"])) for point in of_b],
                         [(5, 2), (80, 2)])
        self.assertEqual({point["simulator"] for point in found["points"] if point not in of_b},
                         {"builtin"})
        _, error = bench("--quick", "--part", "d", "--ticks", "3", "--out", self.out, code=2)
        assert_says(error, "--duration 1 ... 3 ms")

    def test_what_fails_is_told(self):
        """The readout cannot be reached: an encoder without a first scan sends nothing."""
        said, _ = bench("--part", "a", "--encoders", "nef", "--layouts", "separate", "--simulators",
                        "none", "--duration", "0.05", "--trials", "1", "--most", "1000", "--limit",
                        "60", "--out", self.out, code=1)
        self.assertIn("not measured: nef, no simulator, separate, tick 50 ms: 0 spikes were encoded, "
                      "but 0 reached the decoder", said)
        self.assertTrue(results(self.out)["not_measured"][0]["failed"])

    def test_a_simulator_that_is_not_there_is_told(self):
        modules = self.folder / "modules"
        modules.mkdir()
        (modules / "nest.py").write_text("raise ModuleNotFoundError(\"No module named 'nest'\")\n")
        nest = ("--part", "a", "--simulators", "nest", "--encoders", "rate", "--layouts", "separate")
        said, _ = bench(*nest, "--out", self.out, PYTHONPATH=str(modules))
        for layout in ("separate", "alone"):
            self.assertIn(f"not measured: rate, NEST, {layout}, tick 50 ms: NEST is not installed", said)
        (modules / "nest.py").write_text("raise ImportError('libmpi.so is gone')\n")
        said, _ = bench(*nest, "--out", self.out, PYTHONPATH=str(modules))
        assert_says(said, "separate, tick 50 ms: NEST ... ImportError: libmpi.so is gone")
        self.assertNotIn("NEST is not installed", said)


if __name__ == "__main__":
    sys.exit(unittest.main())
