"""The page in Chromium: what it draws, STOP, pause, and a network that goes away."""

import json
import os
import signal
import unittest

import browser
import h5py
import ros
import viewing

# 20 neurons at 1 Hz: spikes that can be told apart in the raster.
FEW_SPIKES = """
experiment: few
duration: 10 h
sync: lockstep
robot: {simulator: mujoco, world: arena.xml}
nodes:
  scan: {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}
  eye: {node: poisson_encoder, rate_min: 1 Hz, rate_max: 1 Hz}
connections:
  - scan[0:20] -> eye
"""

# The number of connected regions of a canvas's pixels of a colour, on a ground that has none.
BLOBS = """
const canvas = document.querySelector(`canvas[data-output="${arguments[0]}"]`);
const {width, height} = canvas;
const alpha = canvas.getContext("2d").getImageData(0, 0, width, height).data.filter((_, i) => i % 4 === 3);
let blobs = 0;
for (let start = 0; start < alpha.length; ++start) {
  if (!alpha[start]) continue;
  ++blobs;
  const open = [start];
  alpha[start] = 0;
  while (open.length) {
    const at = open.pop(), x = at % width;
    for (const next of [at - width, at + width, x ? at - 1 : -1, x < width - 1 ? at + 1 : -1]) {
      if (next >= 0 && next < alpha.length && alpha[next]) { alpha[next] = 0; open.push(next); }
    }
  }
}
return blobs;
"""


class Pages(viewing.FolderCase):
    def test_the_raster_draws_the_spikes_that_were_sent(self):
        experiment = self.folder / "few.yaml"
        experiment.write_text(FEW_SPIKES)
        with viewing.Run(self.folder / "run", experiment=experiment) as job, browser.page(job.url) as page:
            first = page.until(lambda hook: hook.get("simulated_s", 0) > 0)["simulated_s"]
            page.until(lambda hook: hook["simulated_s"] > first + 2.5)  # all of the axis
            page.click("pause")
            statuses = page.until(lambda hook: hook["paused"])["messages"]["/spikeloop/status"]
            paused = page.until(lambda hook: hook["messages"]["/spikeloop/status"] > statuses + 3)  # all is drawn
            begin, end = (1e9 * time for time in paused["range_s"])
            blobs = page.driver.execute_script(BLOBS, "eye.out")
            self.assertEqual(page.complaints(), [])
            code, printed = job.interrupt()
        self.assertEqual(code, 130, printed)
        with h5py.File(self.folder / "run/eye.h5") as file:
            times = file["spikes/out/timestamps_ns"][()]
        shown = int(((times > begin) & (times <= end)).sum())
        self.assertGreater(shown, 25)
        # Some are too near to each other to be told apart, and one may stand at the edge.
        self.assertLessEqual(blobs, shown + 1)
        self.assertGreater(blobs, 0.8 * shown)

    def test_stop_and_pause(self):
        with viewing.Run(self.folder / "run", "--duration", "36000") as job, browser.page(job.url) as page:
            driven = {"level": "ok", "text": "The robot is driven by the network."}
            page.until(lambda hook: hook.get("banner") == driven and hook["pose"])
            self.assertEqual(page.hook()["stop"], "released")
            page.click("stop")
            hook = page.until(lambda hook: hook["stop"] == "pressed" and hook["banner"]["level"] == "error")
            self.assertIn("STOP is pressed", hook["banner"]["text"])
            page.until(lambda hook: not any(hook["sent"]["wheels"].values()))
            page.click("release")
            page.until(lambda hook: hook["stop"] == "released" and hook["banner"] == driven)
            page.click("pause")
            paused = page.until(lambda hook: hook["paused"])["simulated_s"]
            page.click("step")
            page.until(lambda hook: round(1000 * (hook["simulated_s"] - paused)) == 1)
            page.click("pause")
            page.until(lambda hook: not hook["paused"] and hook["simulated_s"] > paused + 0.5)
            self.assertEqual(page.complaints(), [])
            code, printed = job.interrupt()
        self.assertEqual(code, 130, printed)
        self.assertEqual(json.loads((self.folder / "run/summary.json").read_text())
                         ["counters"]["wheels.stops_stop_button"], 1)

    def test_with_the_token_of_the_address_stop_can_be_released(self):
        with viewing.Run(self.folder / "run", "--duration", "36000", "--live-host", "0.0.0.0") as job:
            with browser.page(job.url.replace("0.0.0.0", "127.0.0.1")) as page:
                page.until(lambda hook: hook.get("stop") == "released")
                page.click("stop")
                page.until(lambda hook: hook["stop"] == "pressed")
                page.click("release")
                page.until(lambda hook: hook["stop"] == "released")
                page.click("pause")
                page.until(lambda hook: hook["paused"])
            job.interrupt()

    def test_a_page_that_is_open_before_the_run_begins_has_the_button(self):
        # A process begins seconds after the address is printed.
        with ros.domain(), viewing.Run(self.folder / "run", "--ros", "2", "--sync", "realtime", "--duration", "600",
                                       "--layout", "separate") as job:
            with browser.page(job.url) as page:
                page.until(lambda hook: hook.get("stop") == "released")
                page.click("stop")
                page.until(lambda hook: hook["stop"] == "pressed" and hook["banner"]["level"] == "error")
            job.interrupt()

    def test_the_page_comes_back_when_the_network_was_gone(self):
        with viewing.Run(self.folder / "run", "--duration", "36000") as job, browser.page(job.url) as page:
            page.until(lambda hook: hook.get("spikesDrawn", {}).get("brain.out", 0) > 100)
            page.driver.set_network_conditions(offline=True, latency=0, throughput=0)
            server, = job.servers()
            os.kill(server, signal.SIGSTOP)
            os.kill(server, signal.SIGCONT)
            page.driver.execute_cdp_cmd("Network.enable", {})
            page.driver.delete_network_conditions()
            drawn = page.hook()["spikesDrawn"]["brain.out"]
            page.until(lambda hook: hook["connection"] == "connected"
                       and hook["spikesDrawn"]["brain.out"] > drawn + 100)
            job.interrupt()
            page.until(lambda hook: hook["connection"] == "lost")
            self.assertGreater(page.hook()["spikesDrawn"]["brain.out"], drawn)


if __name__ == "__main__":
    unittest.main()
