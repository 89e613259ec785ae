"""spikeloop view: a run that has ended, from any time on."""

import pathlib
import subprocess
import tempfile
import unittest

import browser
import h5py
import viewing
from runs import programs, run

SPIKELOOP = programs() / "spikeloop"
STATUS = "/spikeloop/status"


class View(viewing.Run):
    """spikeloop view, until the block ends."""

    def __init__(self, folder, *arguments):
        self.folder = folder
        self.start([SPIKELOOP, "view", folder, "--live-port", "0", *arguments])


class RecordedRuns(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name) / "run"
        run(SPIKELOOP, viewing.EXAMPLE, self.folder, "--duration", "12")

    def spikes_between(self, viewer, begin, end):
        """That a viewer got; those of the recording."""
        times, channels = viewing.spikes_of(viewer.messages["/encoder/out"])
        got = [(time, channel) for time, channel in zip(times, channels) if begin < time <= end]
        with h5py.File(self.folder / "encoder.h5") as file:
            recorded = [(int(time), int(channel)) for time, channel in
                        zip(file["spikes/out/timestamps_ns"][()], file["spikes/out/node_ids"][()])
                        if begin < time <= end]
        return got, recorded

    def test_from_any_time_on(self):
        with View(self.folder) as shown:
            viewer = viewing.Viewer(shown.socket_url())
            viewer.until(lambda: STATUS in viewer.messages and viewer.status()["simulated_s"] > 0.5)
            self.assertEqual(viewer.info["metadata"], {"experiment": "braitenberg", "recording": "yes"})
            self.assertEqual(viewer.status()["changeable"],
                             [{"name": "run.time", "minimum": 0, "maximum": 12, "unit": "s"}])
            for time in (8, 3):
                session = viewer.info["sessionId"]
                viewer.set("run.time", time)
                viewer.until(lambda session=session: viewer.info["sessionId"] != session)
                viewer.messages.clear()
                viewer.until(lambda time=time: STATUS in viewer.messages
                             and viewer.status()["simulated_s"] > time + 0.5)
                got, recorded = self.spikes_between(viewer, (time - 2) * 10**9, (time + 0.4) * 10**9)
                self.assertEqual(got, recorded)
                self.assertGreater(len(got), 1000)
            self.assertIn("/scan", viewer.messages)
            self.assertIn("/cmd_vel", viewer.messages)
            viewer.set("run.pause", True)
            viewer.until(lambda: viewer.status()["paused"])
            at = viewer.status()["simulated_s"]
            viewer.set("run.step", 1)
            viewer.until(lambda: round(1000 * (viewer.status()["simulated_s"] - at)) == 1)
            viewer.set("run.pause", False)
            viewer.set("run.speed", 0)
            viewer.until(lambda: viewer.status()["simulated_s"] == 12)
            viewer.set("run.time", 13)
            viewer.until(lambda: viewer.statuses)
            self.assertEqual(viewer.statuses[0]["message"], "parameter 'run.time' is from 0 to 12 s, not 13")
            code, printed = shown.interrupt()
        self.assertEqual((code, printed), (0, ""))
        self.assertEqual(shown.servers(), [])

    def test_in_the_browser(self):
        with View(self.folder) as shown, browser.page(shown.url) as page:
            hook = page.until(lambda hook: hook.get("simulated_s", 0) > 0.5 and hook["pose"])
            self.assertLess(hook["pose"]["t"], hook["simulated_s"] + 0.1)  # not at the end of the path
            page.driver.execute_script(
                "const bar = document.getElementById('slider-run.time'); bar.value = 9;"
                "bar.dispatchEvent(new Event('input', {bubbles: true}));")
            hook = page.until(lambda hook: 9.2 < hook["simulated_s"] < 12 and hook["pose"] and hook["pose"]["t"] > 9)
            self.assertGreater(hook["spikesDrawn"]["encoder.out"], 100)
            self.assertEqual(page.complaints(), [])
            shown.interrupt()

    def test_what_is_no_run(self):
        for arguments, code, wrong in (
                (["view", self.folder.parent], 2, "it is not a run folder"),
                (["view", "/nowhere"], 2, "it is not a run folder"), (["view"], 2, "RUN is required"),
                (["view", self.folder, "--live-host", "192.0.2.1"], 3, "no IPv4 address of this machine")):
            done = subprocess.run([SPIKELOOP, *arguments], capture_output=True, text=True, check=False, timeout=60)
            self.assertEqual(done.returncode, code, f"{arguments}: {done.stderr}")
            self.assertIn(wrong, done.stderr)
        for recording in self.folder.glob("*.h5"):
            recording.unlink()
        done = subprocess.run([SPIKELOOP, "view", self.folder], capture_output=True, text=True, check=False, timeout=60)
        self.assertEqual(done.returncode, 2)
        self.assertIn("has no recordings; run the experiment without --no-record", done.stderr)


if __name__ == "__main__":
    unittest.main()
