"""Parameters that are changed while a run goes on: in the browser, over the protocol, and in the replay."""

import unittest

import browser
import h5py
import numpy
import viewing
from runs import fingerprint, refused, spikeloop

STATUS = "/spikeloop/status"


def again(command, folder, made, *more):
    """A run once more; a replay has the same spikes."""
    spikeloop(command, folder, "--out", made, "--force", "-q", *more)


class Sliders(viewing.FolderCase):
    def rate(self, run, begin, end):
        """Of a neuron of the encoder, in Hz."""
        with h5py.File(run / "encoder.h5") as file:
            times = file["spikes/out/timestamps_ns"][()]
        return int(numpy.count_nonzero((times > begin) & (times <= end))) / 100 / ((end - begin) / 1e9)

    def changeable(self, viewer):
        return {each["name"]: each for each in viewer.status()["changeable"]}

    def test_a_slider_changes_a_rate_and_the_replay_has_the_same_spikes(self):
        run = self.folder / "run"
        with viewing.Run(run, "--duration", "36000") as job, browser.page(job.url) as page:
            page.until(lambda hook: hook.get("parameters", {}).get("encoder.rate_max") == 200)
            page.until(lambda hook: hook["simulated_s"] > 1)
            slider = page.element("slider-encoder.rate_max")
            page.driver.execute_script(
                "arguments[0].value = 800; arguments[0].dispatchEvent(new Event('input', {bubbles: true}));"
                "arguments[0].dispatchEvent(new Event('change', {bubbles: true}));", slider)
            changed = page.until(lambda hook: hook["parameters"]["encoder.rate_max"] == 800)["simulated_s"]
            page.until(lambda hook: hook["simulated_s"] > changed + 1)
            self.assertEqual(page.complaints(), [])
            code, printed = job.interrupt()
        self.assertEqual(code, 130, printed)
        rows = (run / "changes.csv").read_text().splitlines()
        self.assertEqual(rows[0], "t_ns,parameter,value")
        time, name, value = rows[-1].split(",")
        self.assertEqual((name, float(value)), ("encoder.rate_max", 800))
        # Eq. 1 of Weidel et al. 2016: with rate_min near 0 four times rate_max is four times the rate.
        at = int(time)
        before, after = self.rate(run, at - 50_000_000, at), self.rate(run, at, at + 50_000_000)
        self.assertGreater(after, 2 * before)
        again("replay", run, self.folder / "replay")
        self.assertEqual((self.folder / "replay/changes.csv").read_text(), (run / "changes.csv").read_text())

    def test_a_run_that_is_repeated_has_the_changes_too(self):
        first = self.folder / "first"
        with viewing.Run(first, "--duration", "20") as job:
            viewer = viewing.Viewer(job.socket_url(), STATUS)
            viewer.until(lambda: STATUS in viewer.messages)
            self.assertEqual(self.changeable(viewer)["encoder.rate_max"],
                             {"name": "encoder.rate_max", "minimum": 0, "maximum": 800, "unit": "Hz"})
            viewer.set("encoder.rate_max", 20)
            viewer.set("encoder.rate_min", -1)
            viewer.set("encoder.rate_min", 2_000_000)
            viewer.until(lambda: len(viewer.statuses) == 2)
            self.assertEqual(viewer.statuses[0]["message"],
                             "parameter 'encoder.rate_min' is from 0 to 1000000 Hz, not -1")
            viewer.set("encoder.rate_min", 10)
            viewer.until(lambda: viewer.parameters.get("encoder.rate_min") == 10)
            viewer.set("run.speed", 0)
            code, printed = job.end()
        self.assertEqual(code, 0, printed)
        rows = (first / "changes.csv").read_text().splitlines()[1:]
        self.assertEqual(sorted(row.split(",")[1:] for row in rows),
                         [["encoder.rate_max", "20"], ["encoder.rate_min", "10"]])
        with viewing.Run(self.folder / "second", experiment=first) as job:
            viewer = viewing.Viewer(job.socket_url(), STATUS)
            viewer.until(lambda: STATUS in viewer.messages)
            viewer.send(op="subscribeParameterUpdates", parameterNames=[])
            viewer.send(op="getParameters", parameterNames=[], id="all")  # the change may have been before
            viewer.until(lambda: viewer.parameters.get("encoder.rate_max") == 20)
            viewer.set("run.speed", 0)
            code, printed = job.end()
        self.assertEqual(code, 0, printed)
        self.assertEqual(fingerprint(first), fingerprint(self.folder / "second"))

    def test_changes_of_a_layout_of_several_processes(self):
        run = self.folder / "run"
        with viewing.Run(run, "--duration", "6", "--sync", "realtime",
                         "--set", "layout={control: [scan, decoder, wheels], network: [encoder, brain]}") as job:
            viewer = viewing.Viewer(job.socket_url(), STATUS)
            # Not the first status, which may be the other process's.
            viewer.until(lambda: STATUS in viewer.messages and "encoder.rate_max" in self.changeable(viewer))
            viewer.set("encoder.rate_max", 50)
            code, printed = job.end()
        self.assertEqual(code, 0, printed)
        self.assertIn(",encoder.rate_max,50", (run / "changes.csv").read_text())
        again("replay", run, self.folder / "replay")

    def test_changes_hold_from_their_time_on_in_whatever_order_they_stand(self):
        run = self.folder / "run"
        spikeloop("run", viewing.EXAMPLE, "--duration", "1", "--out", run, "-q")
        rows = ["600000000,encoder.rate_max,100", "300000000,encoder.rate_min,20"]  # of two processes
        for name, order in (("one", rows), ("two", rows[::-1])):
            incomplete = "700000000,encoder.rate_max,1"  # without its last digit and line end
            (run / "changes.csv").write_text("\n".join(["t_ns,parameter,value", *order, incomplete]))
            again("run", run, self.folder / name)
        self.assertEqual(fingerprint(self.folder / "one"), fingerprint(self.folder / "two"))
        self.assertNotEqual(fingerprint(self.folder / "one"), fingerprint(run))
        self.assertEqual((self.folder / "one/changes.csv").read_text().splitlines()[1:], rows[::-1])

    def test_changes_that_were_written_by_hand(self):
        run = self.folder / "run"
        spikeloop("run", viewing.EXAMPLE, "--duration", "1", "--out", run, "-q")
        for rows, wrong in (("time,x\n", "changes.csv:1: this is not a row  t_ns,parameter,value"),
                            ("t_ns,parameter,value\n1,encoder,2\n", "changes.csv:2: this is not a row"),
                            ("t_ns,parameter,value\n1,encoder.rate_max,x\n", "changes.csv:2: this is not a row"),
                            ("t_ns,parameter,value\n1,eye.rate_max,2\n", "'1,eye.rate_max,2' is no change"),
                            ("t_ns,parameter,value\n1,encoder.seed,2\n", "'1,encoder.seed,2' is no change"),
                            ("t_ns,parameter,value\n1,encoder.rate_max,-2\n", "'1,encoder.rate_max,-2' is no change")):
            (run / "changes.csv").write_text(rows)
            refused(wrong, "replay", run, "--out", self.folder / "replay")


if __name__ == "__main__":
    unittest.main()
