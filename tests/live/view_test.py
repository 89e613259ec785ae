"""spikeloop view: a run that has ended, from any time on."""

import os
import signal
import subprocess
import time
import unittest

import browser
import h5py
import viewing
from mcap_file import McapFile
from runs import SPIKELOOP, programs, recordings, refused, run, spikeloop
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

STATUS = "/spikeloop/status"


class View(viewing.Run):
    """spikeloop view, until the block ends."""

    def __init__(self, folder, *arguments):
        self.folder = folder
        self.start([SPIKELOOP, "view", folder, "--live-port", "0", *arguments])


class RecordedRuns(viewing.FolderCase):
    def setUp(self):
        super().setUp()
        self.folder /= "run"
        run(viewing.EXAMPLE, self.folder, "--duration", "12")

    def spikes_between(self, viewer, begin, end):
        """That a viewer got; those of the recording."""
        times, channels = viewing.spikes_of(viewer.messages["/encoder/out"])
        got = [(time, channel) for time, channel in zip(times, channels) if begin < time <= end]
        recorded = [(int(time), int(channel)) for time, channel in zip(*recordings.spikes(self.folder, "encoder"))
                    if begin < time <= end]
        return got, recorded

    def test_from_any_time_on(self):
        with View(self.folder) as shown:
            viewer = viewing.Viewer(shown.socket_url())
            viewer.until(lambda: STATUS in viewer.messages and viewer.status()["simulated_s"] > 0.5)
            self.assertEqual(viewer.info["metadata"], {"experiment": "braitenberg", "recording": "yes"})
            self.assertEqual(viewer.status()["changeable"],
                             [{"name": "run.time", "minimum": 0, "maximum": 12, "unit": "s"}])
            for begin in (8, 3):
                session = viewer.info["sessionId"]
                viewer.set("run.time", begin)
                viewer.until(lambda session=session: viewer.info["sessionId"] != session)
                viewer.messages.clear()
                viewer.until(lambda begin=begin: STATUS in viewer.messages
                             and viewer.status()["simulated_s"] > begin + 0.5)
                got, recorded = self.spikes_between(viewer, (begin - 2) * 10**9, (begin + 0.4) * 10**9)
                self.assertEqual(got, recorded)
                self.assertGreater(len(got), 1000)
            self.assertIn("/scan", viewer.messages)
            self.assertIn("/cmd_vel", viewer.messages)
            viewer.set("run.pause", True)
            viewer.until(lambda: viewer.status()["paused"])
            session = viewer.info["sessionId"]
            viewer.set("run.time", 6)
            viewer.until(lambda: viewer.info["sessionId"] != session)
            viewer.messages.clear()
            viewer.until(lambda: STATUS in viewer.messages and viewer.status()["simulated_s"] == 6)
            got, recorded = self.spikes_between(viewer, 4 * 10**9, 6 * 10**9)
            self.assertEqual(got, recorded)
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

    def test_it_begins_with_the_first_viewer(self):
        with View(self.folder) as shown:
            time.sleep(1)
            viewer = viewing.Viewer(shown.socket_url())
            viewer.until(lambda: STATUS in viewer.messages and viewer.status()["simulated_s"] > 0.5)
            got, recorded = self.spikes_between(viewer, 0, int(0.4e9))
            self.assertEqual(got, recorded)
            viewer.send(op="getParameters", parameterNames=["run.speed"], id="one")
            viewer.until(lambda: list(viewer.parameters) == ["run.speed"])

    def test_it_ends_with_its_server(self):
        with View(self.folder) as shown:
            server, = shown.servers()
            os.kill(server, signal.SIGKILL)
            code, printed = shown.end()
        self.assertEqual(code, 3, printed)
        self.assertIn("spikeloop-live, the server of the live view, has ended", printed)

    def test_a_run_from_python(self):
        root = programs().parent
        code = ("import sys, spikeloop\n"
                "spikeloop.load(sys.argv[1]).run(out=sys.argv[2], duration='2 s')")
        subprocess.run(["/usr/bin/python3", "-c", code, viewing.EXAMPLE, self.folder.parent / "python"], check=True,
                       timeout=120, env={**os.environ, "PYTHONPATH": str(root / "share/spikeloop/python")})
        with View(self.folder.parent / "python") as shown:
            viewer = viewing.Viewer(shown.socket_url())
            viewer.until(lambda: "/encoder/out" in viewer.messages)

    def test_one_file_has_all(self):
        file = self.folder.parent / "run.mcap"
        command = ["view", self.folder, "--out", file]
        out, said = spikeloop(*command)
        self.assertEqual(out, f"{file}\n")
        self.assertIn("finished: 12.0 of 12 s", said)
        exported, messages = McapFile(file), McapFile(self.folder / "messages.mcap")
        self.assertTrue(exported.ended)
        self.assertEqual(exported.attachments, messages.attachments)
        for topic in ("/scan", "/cmd_vel"):
            self.assertEqual(exported.raw(topic), messages.raw(topic))
            self.assertEqual(exported.type_of(topic), messages.type_of(topic))
            self.assertEqual(exported.nodes_of(topic), messages.nodes_of(topic))
        for node in ("encoder", "brain"):
            times, channels = viewing.spikes_of(exported.raw(f"/{node}/out"))
            self.assertEqual([times, channels], [list(each) for each in recordings.spikes(self.folder, node)])
            self.assertGreater(len(times), 10_000)
            self.assertEqual(exported.nodes_of(f"/{node}/out"), {node})
        for node, name in (("decoder", "out"), ("wheels", "command"), ("wheels", "latency")):
            wanted = list(zip(*(each.tolist() for each in recordings.signal(self.folder, node, name))))
            got = [(at, viewing.signal_of(message)) for at, message in exported.raw(f"/{node}/{name}")]
            self.assertEqual(got, wanted)
        self.same_channels_as_the_view(exported)
        again = self.folder.parent / "again"  # with the messages of that file
        run(viewing.EXAMPLE, again, "--duration", "11 s", "--sync", "unpaced", "--set", f"robot={{bag: {file}}}")
        with h5py.File(again / "encoder.h5") as first, h5py.File(self.folder / "encoder.h5") as second:
            spikes = first["spikes/out/timestamps_ns"][()]
            self.assertEqual(list(spikes), list(second["spikes/out/timestamps_ns"][:len(spikes)]))
            self.assertGreater(len(spikes), 10_000)
        refused("write --force to replace it", *command)
        spikeloop(*command, "--force")

    def same_channels_as_the_view(self, exported):
        with View(self.folder) as shown:
            viewer = viewing.Viewer(shown.socket_url())
            topics = {topic for _, topic, _, _ in exported.channels.values()}
            viewer.until(lambda: topics <= {each["topic"] for each in viewer.channels.values()})
        served = {each["topic"]: (each["schemaName"], each["encoding"], each["schemaEncoding"], each["schema"])
                  for each in viewer.channels.values() if not each["topic"].startswith("/spikeloop/")}
        self.assertEqual({topic: exported.type_of(topic) for topic in topics}, served)

    def test_ctrl_c_leaves_the_older_file(self):
        file, part = (self.folder.parent / name for name in ("run.mcap", "run.mcap.part"))
        file.write_text("older")
        with h5py.File(self.folder / "encoder.h5", "r+") as recording:  # so that it takes long
            for name, value in (("timestamps_ns", 10**15), ("node_ids", 0)):
                data = recording["spikes/out"][name]
                data.resize((len(data) + 1,))
                data[-1] = value
        export = subprocess.Popen([SPIKELOOP, "view", self.folder, "--out", file, "--force"], stderr=subprocess.PIPE,
                                  text=True)
        while not part.exists():
            self.assertIsNone(export.poll())
            time.sleep(0.01)
        export.send_signal(signal.SIGINT)
        _, printed = export.communicate(timeout=60)
        self.assertEqual(export.returncode, 130, printed)
        self.assertEqual((file.read_text(), part.exists()), ("older", False))

    def test_in_the_browser(self):
        with View(self.folder) as shown, browser.page(shown.url) as page:
            hook = page.until(lambda hook: hook.get("simulated_s", 0) > 0.5 and hook["pose"])
            self.assertLess(hook["pose"]["t"], hook["simulated_s"] + 0.1)  # not at the end of the path
            page.click('[data-show="decoder.out"]', By.CSS_SELECTOR)
            shown_rows = self.rows(page)
            bar = page.element("slider-run.time")
            page.click("pause")
            page.until(lambda hook: hook["paused"])
            # To the right in small steps, then a bit back; the bar stays the same one.
            drag = ActionChains(page.driver).click_and_hold(bar)
            for pixels in [4] * 8 + [-4] * 2:
                drag = drag.move_by_offset(pixels, 0).pause(0.1)
            drag.perform()
            hook = page.until(lambda hook: hook["simulated_s"] == hook["parameters"]["run.time"] > 6)
            self.assertAlmostEqual(float(bar.get_property("value")), hook["simulated_s"])
            ActionChains(page.driver).release().perform()
            hook = page.until(lambda hook: hook["spikesDrawn"]["encoder.out"] > 100)
            self.assertEqual(hook["range_s"][1], hook["simulated_s"])
            self.assertEqual(self.rows(page), shown_rows)
            page.click("pause")
            page.until(lambda after: after["simulated_s"] > hook["simulated_s"] + 0.2 and after["pose"]
                       and after["pose"]["t"] > hook["simulated_s"])
            self.assertEqual(page.complaints(), [])
            shown.interrupt()

    def rows(self, page):
        """Names of the rows that the page shows."""
        return [row.get_attribute("data-row") for row in page.driver.find_elements(By.CSS_SELECTOR, "#rows .row")]

    def test_what_is_no_run(self):
        (self.folder.parent / "folder.mcap").mkdir()
        for arguments, code, wrong in (
                (["view", self.folder.parent], 2, f"'{self.folder.parent}' cannot be shown: ... [SL0109]"),
                (["view", self.folder, "--out", "run.bag"], 2, "write a name with .mcap"),
                (["view", self.folder, "--out", self.folder / "messages.mcap", "--force"], 2, "would be overwritten"),
                (["view", self.folder, "--out", self.folder / "no/folder.mcap"], 4, "cannot create"),
                (["view", self.folder, "--out", self.folder.parent / "folder.mcap", "--force"], 2, "not a regular file"),
                (["view", self.folder, "--force"], 2, "--force requires --out"),
                (["view", "/nowhere"], 2, "'/nowhere' ... [SL0109]"), (["view"], 2, "RUN is required"),
                (["view", self.folder, "--live-host", "192.0.2.1"], 3, "no IPv4 address of this machine")):
            refused(wrong, *arguments, code=code)
        for recording in self.folder.glob("*.h5"):
            recording.unlink()
        refused("has no recordings; run the experiment without --no-record", "view", self.folder)


if __name__ == "__main__":
    unittest.main()
