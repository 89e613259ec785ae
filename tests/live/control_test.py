"""Pause, single steps and speed."""

import time
import unittest

import viewing

STATUS = "/spikeloop/status"


class Control(viewing.FolderCase):
    def test_pause_step_and_speed(self):
        with viewing.Run(self.folder / "run", "--duration", "36000") as job:
            viewer = viewing.Viewer(job.socket_url(), STATUS)
            viewer.until(lambda: STATUS in viewer.messages)
            viewer.set("run.pause", True)
            viewer.until(lambda: viewer.status()["paused"])
            paused_at = viewer.status()["simulated_s"]
            for step in range(1, 4):
                viewer.set("run.step", step)
                viewer.until(lambda step=step: round((viewer.status()["simulated_s"] - paused_at) / 1e-3) == step)
            seen = len(viewer.messages[STATUS])
            viewer.until(lambda: len(viewer.messages[STATUS]) > seen + 5)
            self.assertAlmostEqual(viewer.status()["simulated_s"] - paused_at, 3e-3, 9)
            viewer.set("run.speed", 0.5)
            first = viewer.status()
            began = time.monotonic()
            viewer.set("run.pause", False)
            viewer.until(lambda: viewer.status()["simulated_s"] > first["simulated_s"] + 1)
            self.assertGreater(time.monotonic() - began, 1.9)  # 2 s
            viewer.set("run.speed", 0)
            viewer.until(lambda: viewer.status()["simulated_s"] > first["simulated_s"] + 10)
            viewer.set("run.speed", -1)
            viewer.set("run.pause", "yes")
            viewer.set("encoder.rate", 1)
            viewer.until(lambda: len(viewer.statuses) == 3)
            self.assertEqual([status["message"] for status in viewer.statuses],
                             ["parameter 'run.speed' is 0 or more, not -1",
                              "parameter 'run.pause' is true or false, not \"yes\"",
                              "this run has no parameter 'encoder.rate'"])
            code, printed = job.interrupt()
        self.assertEqual(code, 130, printed)

    def test_a_run_that_follows_a_clock_cannot_be_paused(self):
        with viewing.Run(self.folder / "run", "--sync", "realtime", "--duration", "600") as job:
            viewer = viewing.Viewer(job.socket_url(), STATUS)
            viewer.until(lambda: STATUS in viewer.messages)
            viewer.send(op="getParameters", parameterNames=[], id="all")
            viewer.until(lambda: viewer.parameters)
            self.assertEqual([name for name in viewer.parameters if name.startswith("run.")], ["run.stop"])
            job.interrupt()


if __name__ == "__main__":
    unittest.main()
