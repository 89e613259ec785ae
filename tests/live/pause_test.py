"""A pause longer than all limits: before the first tick of a simulator, around it, and of a robot that is stepped over
ROS 2. The run ends well, with the spikes of a run without a pause."""

import shutil
import time
import unittest

import ros
import viewing
from runs import fingerprint, new_experiment, run

CELLS = viewing.EXAMPLE.parents[1] / "09_neuron/brain.py"
STATUS = "/spikeloop/status"
START_S, STALL_S = 20, 5
EXPERIMENT = """experiment: cells
duration: 300 ms
sync: lockstep
robot: {simulator: mujoco}
nodes:
  scan: {node: ros_sensor, topic: /scan, message: LaserScan}
  encoder: {node: rate_encoder, rate_max: 200 Hz}
  brain: {simulator: neuron, script: brain.py}
  decoder: {node: linear_readout, tau: 30 ms, weights: [[0.02, 0.02, 0.02], [0.02, 0, -0.02]]}
  wheels: {node: ros_command, topic: /cmd_vel, message: Twist, fields: {linear.x: 0, angular.z: 1}}
connections:
  - scan[0:3] -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]
"""


class Pause(viewing.FolderCase):
    def stay(self, viewer, seconds):
        """Reads for so long; the run stands still meanwhile."""
        at = viewer.status()["simulated_s"]
        end = time.monotonic() + seconds
        viewer.until(lambda: time.monotonic() > end, 2 * seconds)
        self.assertEqual((viewer.status()["paused"], viewer.status()["simulated_s"]), (True, at))

    def pause(self, viewer):
        """As soon as there is a run."""
        end = time.monotonic() + 60
        while not viewer.parameters.get("run.pause"):
            self.assertLess(time.monotonic(), end)
            viewer.set("run.pause", True)
            viewer.until(lambda: viewer.statuses or viewer.parameters.get("run.pause"))
            viewer.statuses.clear()
        viewer.until(lambda: STATUS in viewer.messages and viewer.status()["paused"], 120)

    def finish(self, job, viewer):
        viewer.set("run.speed", 0)
        viewer.set("run.pause", False)
        viewer.until_closed()
        code, printed = job.end()
        self.assertEqual(code, 0, printed)
        self.assertIn("finished", printed)

    def test_a_simulator(self):
        text = CELLS.read_text()
        experiment = self.folder / "cells.yaml"
        experiment.write_text(EXPERIMENT)
        (self.folder / "brain.py").write_text(text)
        run(experiment, self.folder / "alone")
        # Time for a viewer to come before the first tick.
        (self.folder / "brain.py").write_text(text.replace("    host.run(", "    import time; time.sleep(4)\n    host.run("))
        with viewing.Run(self.folder / "run", "--start-timeout", str(START_S), "--stall-timeout", str(STALL_S),
                         experiment=experiment) as job:
            viewer = viewing.Viewer(job.socket_url())
            self.pause(viewer)
            self.assertEqual(viewer.status()["simulated_s"], 0)
            self.stay(viewer, START_S + 2)
            viewer.set("run.step", 1)
            viewer.until(lambda: viewer.status()["simulated_s"] > 0)
            self.stay(viewer, START_S + 2)
            self.finish(job, viewer)
        shutil.rmtree(self.folder / "run/experiment-files", ignore_errors=True)
        self.assertEqual(fingerprint(self.folder / "run"), fingerprint(self.folder / "alone"))

    def test_it_can_be_stopped_before_its_first_tick(self):
        experiment = self.folder / "cells.yaml"
        experiment.write_text(EXPERIMENT)
        shutil.copy(CELLS, self.folder / "brain.py")
        with viewing.Run(self.folder / "run", experiment=experiment) as job:
            viewer = viewing.Viewer(job.socket_url())
            self.pause(viewer)
            code, printed = job.interrupt()
        self.assertEqual(code, 130, printed)

    def test_a_robot_that_is_stepped(self):
        with ros.domain():
            experiment = new_experiment(self.folder / "far.yaml", sync="lockstep", ros="2", duration="3 s")
            run(experiment, self.folder / "alone")
            with viewing.Run(self.folder / "run", "--start-timeout", str(START_S), "--stall-timeout", str(STALL_S),
                             experiment=experiment) as job:
                viewer = viewing.Viewer(job.socket_url())
                viewer.until(lambda: STATUS in viewer.messages and viewer.status()["simulated_s"] > 0.1, 120)
                self.pause(viewer)
                self.stay(viewer, 2 * STALL_S)
                self.finish(job, viewer)
        self.assertEqual(fingerprint(self.folder / "run"), fingerprint(self.folder / "alone"))


if __name__ == "__main__":
    unittest.main()
