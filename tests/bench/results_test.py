"""results.json, and table and pictures of it."""

import json
import pathlib
import unittest

from bench_program import FolderCase
from spikeloop.bench import chain, paper, pictures, results, search, sweeps, table


def setting(layout="fused", encoder="rate", simulator="none", tick_ms=50, neurons=1000,
            rates=(1, 2)):
    return chain.Setting(layout, encoder, simulator, tick_ms, neurons, *rates, 10.0)


def trial(factor):
    return {"build_s": 0.1, "run_s": 10 / factor, "real_time_factor": factor, "spikes": 15_000}


class Folder(FolderCase):
    def results(self):
        return results.Results(self.folder, {**paper.as_json(), "duration_s": 10.0})


class Keeping(Folder):
    def test_trials_are_added_to_and_the_median_counts(self):
        for factor, median in ((3.0, 3.0), (1.0, 2.0), (1.5, 1.5)):
            kept = self.results()  # as after a stop
            kept.add_trial(kept.point(setting().keys()), trial(factor))
            self.assertEqual(self.results().point(setting().keys())["real_time_factor"], median)
        self.assertEqual(len(self.results().points), 1)
        self.assertEqual(len(self.results().point(setting().keys())["trials"]), 3)
        self.assertEqual(self.results().point(setting(neurons=2000).keys())["trials"], [])

    def test_what_was_not_measured_is_forgotten_when_it_is_tried_again(self):
        kept, keys = self.results(), sweeps.curve_of(setting())
        kept.lacks(keys, "out of time", False)
        kept.lacks(keys, "no memory")
        self.assertEqual(self.results().not_measured,
                         [{**keys, "reason": "no memory", "failed": True}])
        kept.settle(keys)
        self.assertEqual(kept.not_measured, [])

    def test_the_largest_number_is_replaced(self):
        kept, keys = self.results(), sweeps.curve_of(setting())
        kept.set_largest(keys, search.Found(5, 6))
        kept.set_largest(keys, search.Found(7, None))
        self.assertEqual(self.results().largest, [{**keys, "neurons": 7, "next": None}])

    def test_errors(self):
        file = self.folder / results.NAME
        for text, said in (("{", "is not what spikeloop bench writes; move it away, or write another folder "
                                 "with --out"),
                           ("[]", "is not what "),
                           ('{"points": []}', ".* 'duration_s'; move"),
                           ('{"format": 2}', "was written by a newer Spikeloop; write another folder "
                                             "with --out")):
            with self.subTest(text=text):
                file.write_text(text)
                with self.assertRaisesRegex(results.ResultsError, f"'{file}' {said}") as caught:
                    self.results()
                self.assertEqual(caught.exception.code, 4)
        file.unlink()
        file.mkdir()
        with self.assertRaisesRegex(results.ResultsError, f"cannot read '{file}': Is a directory"):
            self.results()

    def test_another_machine_is_refused(self):
        kept = self.results()
        kept.add_trial(kept.point(setting().keys()), trial(2.0))
        file = self.folder / results.NAME
        known = json.loads(file.read_text())
        self.results().refuse_other_machine()
        known["machine"]["cpu"] = "Zuse Z3"
        file.write_text(json.dumps(known))
        with self.assertRaisesRegex(results.ResultsError,
                                    r"was measured on another machine \(cpu: Zuse Z3, here .*\); write "
                                    "another folder with --out, or --draw to look at it") as caught:
            self.results().refuse_other_machine()
        self.assertEqual(caught.exception.code, 2)

    def test_a_folder_that_cannot_be_written(self):
        kept = results.Results(pathlib.Path("/proc"), {"duration_s": 10.0})
        with self.assertRaisesRegex(results.ResultsError, "^cannot write '/proc/results.json': "):
            kept.keep()


class Showing(Folder):
    def everything(self):
        """Made-up results of all parts."""
        kept = self.results()
        for layout in ("fused", "separate"):
            for encoder in chain.ENCODERS:
                for tick_ms in (50, 1) if encoder == "rate" else (50,):
                    for neurons in (1000, 10_000, 100_000):
                        one = setting(layout, encoder, tick_ms=tick_ms, neurons=neurons)
                        for factor in (0.9, 1.0, 1.2):
                            kept.add_trial(kept.point(one.keys()), trial(factor * 50_000 / neurons))
                    kept.set_largest(sweeps.curve_of(one), search.Found(50_000, 51_000))
            for rate, factor in ((40, 3.0), (100, 0.8), (400, 1.1)):
                one = setting(layout, neurons=50_000, rates=(rate, rate))
                kept.add_trial(kept.point(one.keys()), trial(factor))
            for tick_ms in (1, 50):
                keys = {"layout": layout, "tick_ms": tick_ms, "network": False}
                kept.add_latency(keys, {**keys, "median_ms": tick_ms, "p90_ms": tick_ms,
                                        "p99_ms": 2.0 * tick_ms, "min_ms": 0.5 * tick_ms,
                                        "answered": 3, "trials": 3})
        for layout, neurons in (("alone", 40_000), ("separate", 38_000)):
            kept.set_largest(sweeps.curve_of(setting(layout, simulator="nest")),
                             search.Found(neurons, neurons + 1000))
        kept.lacks(sweeps.curve_of(setting("fused", simulator="nest")), "why", False)
        return kept.document()

    def test_table(self):
        lines = list(table.lines(self.everything()))
        rows = [line.split() for line in lines]
        self.assertIn("rate neurons in real time, no simulator, fused 50,000 10,000,000 150,000".split(),
                      rows)
        self.assertIn("nef neurons in real time, no simulator, separate 50,000 200,000 20,000".split(),
                      rows)
        # 400 Hz happens to be in real time, but 100 Hz is not.
        self.assertIn("rate of 50,000 neurons in real time, fused 40 Hz 800 Hz 40 Hz".split(), rows)
        self.assertIn("rate neurons in real time at a tick of 1 ms, separate 50,000 20,000 "
                      "10,000".split(), rows)
        self.assertIn("NEST in a job over NEST alone, separate 0.95 0.9".split(), rows)
        self.assertIn("latency, fused, tick 1 ms: median 1.00 ms, 99 % 2.00 ms, 3 of 3 answered", lines)
        self.assertEqual(lines[-1], "not measured: rate, NEST, fused, tick 50 ms: why")

    def test_a_share_of_bounds_is_a_bound(self):
        for coupled, alone, share in ((None, 41_000, "0.95 or more"), (39_000, None, "0.95 or less"),
                                      (None, None, "not known")):
            kept = self.results()
            for layout, found in (("separate", search.Found(38_000, coupled)),
                                  ("alone", search.Found(40_000, alone))):
                kept.set_largest(sweeps.curve_of(setting(layout, simulator="nest")), found)
            rows = [line.split() for line in table.lines(kept.document())]
            self.assertIn(f"NEST in a job over NEST alone, separate {share} 0.9".split(), rows)

    def test_pictures(self):
        drawn = pictures.draw(self.everything(), self.folder)
        self.assertEqual([path.name for path in drawn], ["a.png", "b.png", "c.png", "d.png"])
        for path in drawn:
            self.assertEqual(path.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
            self.assertGreater(path.stat().st_size, 10_000)

    def test_pictures_that_cannot_be_written(self):
        kept = self.results()
        kept.add_latency({}, {"layout": "fused", "tick_ms": 1, "median_ms": 1, "min_ms": 1, "p99_ms": 1})
        document = kept.document()
        (self.folder / "c.png").mkdir()
        with self.assertRaisesRegex(results.ResultsError,
                                    f"^cannot write '{self.folder}/c.png': Is a directory$"):
            pictures.draw(document, self.folder)
        with self.assertRaisesRegex(results.ResultsError, "^cannot write '/proc/c.png': "):
            pictures.draw(document, pathlib.Path("/proc"))

    def test_the_papers_values_are_in_the_pictures(self):
        """As a line or point at their places."""
        document = self.everything()
        figure = pictures._part_a(document)  # noqa: SLF001
        found = {axes.get_title("left"): [line.get_xdata()[0] for line in axes.lines
                                          if "paper" in str(line.get_label())]
                 for axes in figure.axes if axes.get_title("left")}
        self.assertEqual(found["rate, fused"], [150_000])
        self.assertEqual(found["poisson, separate"], [150_000])
        self.assertEqual(found["nef, separate"], [20_000])
        marks = [line.get_xdata()[0] for line in pictures._part_b(document).axes[1].lines
                 if "paper" in str(line.get_label())]
        self.assertEqual(marks, [40])
        marks = [(*line.get_xdata(), *line.get_ydata()) for axes in pictures._part_d(document).axes
                 for line in axes.lines if "paper" in str(line.get_label())]
        self.assertEqual(marks, [(1, 10_000)] * 2)

    def test_upper_bounds_are_hollow(self):
        kept = self.results()
        for layout in ("fused", "separate"):
            one = setting(layout)
            kept.add_trial(kept.point(one.keys()), {**trial(0.5), "stopped": True})
        figure = pictures._part_a(kept.document())  # noqa: SLF001
        hollow = {axes.get_title("left"): [line.get_xdata()[0] for line in axes.lines
                                           if line.get_markerfacecolor() == "white"
                                           and len(line.get_xdata())]
                  for axes in figure.axes}
        self.assertEqual(hollow["rate, separate"], [1000])
        self.assertEqual(hollow["rate, fused"], [])

    def test_what_was_edited_is_told_before_anything_is_drawn(self):
        self.everything()
        file = self.folder / results.NAME
        whole = file.read_text()

        def refused(change, said):
            known = json.loads(whole)
            change(known)
            file.write_text(json.dumps(known))
            with self.assertRaises(results.ResultsError) as caught:
                self.results()
            self.assertEqual(str(caught.exception),
                             f"'{file}' is not what spikeloop bench writes: {said}; move it away, or "
                             "write another folder with --out")
            self.assertEqual(caught.exception.code, 4)
        refused(lambda known: known["points"][2].pop("neurons"), "points[2] has no 'neurons'")
        refused(lambda known: known["points"][1]["trials"][0].clear(),
                "points[1].trials[0] has no 'real_time_factor'")
        refused(lambda known: known["points"][0].update(tick_ms="50"),
                "'tick_ms' of points[0] is '50', not a number")
        refused(lambda known: known["points"][0].update(neurons=True),
                "'neurons' of points[0] is True, not a number")
        refused(lambda known: known["points"][0].update(real_time_factor=None),
                "'real_time_factor' of points[0] is None, not a number")
        refused(lambda known: known["points"][0].update(trials={}),
                "'trials' of points[0] is {}, not a list")
        refused(lambda known: known["points"].append(3), f"points[{self.points(whole)}] is not an object")
        refused(lambda known: known["largest"][0].update(simulator="neuro"),
                "'simulator' of largest[0] is 'neuro', not one of none, builtin, nest, neuron, brian2")
        refused(lambda known: known["largest"][0].update(next="6"),
                "'next' of largest[0] is '6', not a number or null")
        refused(lambda known: known["latencies"][1].pop("median_ms"), "latencies[1] has no 'median_ms'")
        refused(lambda known: known["latencies"][0].update(network=0),
                "'network' of latencies[0] is 0, not true or false")
        refused(lambda known: known["not_measured"][0].update(reason=["no"] * 20),
                "'reason' of not_measured[0] is " + str(["no"] * 20)[:37] + "..., not text")
        refused(lambda known: known.pop("duration_s"), "the file has no 'duration_s'")
        refused(lambda known: known.update(machine=None), "'machine' of the file is None, not an object")

    @staticmethod
    def points(text):
        return len(json.loads(text)["points"])

    def test_nothing_is_drawn_of_nothing(self):
        document = self.results().document()
        self.assertEqual(pictures.draw(document, self.folder), [])
        self.assertEqual(list(table.lines(document)), [])


if __name__ == "__main__":
    unittest.main()
