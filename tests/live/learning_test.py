"""What a run learns: episodes are those of episodes.csv, weights those that the run saves."""

import struct
import unittest

import browser
import numpy as np
import viewing
from runs import fingerprint, recordings, run, spikeloop

END_NS = 40 * 10**9  # of the runs

# 300 synapses that learn, of which 256 are shown.
PAIRS = """
experiment: pairs
duration: 40 s
tick: 1 ms
sync: unpaced
nodes:
  brain:
    simulator: builtin
    network:
      resolution: 0.1 ms
      populations:
        rain: {model: poisson, size: 300, parameters: {rate: 20 Hz}}
        cell: {model: iaf_psc_exp, size: 1}
      connections:
        - {from: rain, to: cell, rule: all_to_all, weight: 50 pA, delay: 1 ms,
           plasticity: {rule: stdp, lambda: 0.02, Wmax: 100 pA, save: learned.npy}}
      output: [cell]
  copy: {simulator: builtin, network: {populations: {in: {model: input, size: 1}, out: {model: repeater, size: 1}}, output: [out]}}
connections:
  - brain -> copy
"""


def weights_of(message):
    """The number of synapses, and the weights that were sent."""
    synapses, count = struct.unpack_from("<QI", message, 4)
    assert len(message) == 20 + 8 * count  # the weights are aligned to 8
    return synapses, np.array(struct.unpack_from(f"<{count}d", message, 20))


class Learning(viewing.FolderCase):
    def lake(self):
        path = self.folder / "lake.yaml"
        path.write_text(spikeloop("new", "lake", "--environment", "frozen_lake")[0])
        return path

    def run_both(self, experiment, topics, *arguments):
        """With a viewer and without; the viewer's last weights of each topic."""
        viewer = viewing.watched(
            self.folder / "live", topics, 0,
            lambda viewer: all(viewer.messages[topic][-1][0] == END_NS for topic in topics),
            *arguments, experiment=experiment)
        run(experiment, self.folder / "alone", *arguments)
        self.assertEqual(fingerprint(self.folder / "live"), fingerprint(self.folder / "alone"))
        channels = viewer.channels.values()
        self.assertEqual(topics, {each["topic"] for each in channels if each["schemaName"] == "spikeloop/msg/Weights"})
        return {topic: weights_of(viewer.messages[topic][-1][1]) for topic in topics}

    def saved(self, file):
        """A row a target, a column a source; the same with a view and without."""
        with_view, alone = (np.load(self.folder / run / file) for run in ("live", "alone"))
        np.testing.assert_array_equal(with_view, alone)
        return alone

    def test_weights_of_rate_neurons_are_those_that_the_run_saves(self):
        topics = {"/brain/input.actor", "/brain/input.critic"}
        for topic, (synapses, weights) in self.run_both(self.lake(), topics, "--duration", "40").items():
            saved = self.saved(f"brain.{topic.split('.')[1]}.npy")
            self.assertEqual(synapses, saved.size)
            np.testing.assert_array_equal(weights, saved.T.ravel())  # source by source
            self.assertGreater(np.ptp(weights), 0)

    def test_of_many_synapses_evenly_chosen_ones_are_shown(self):
        experiment = self.folder / "pairs.yaml"
        experiment.write_text(PAIRS)
        (synapses, weights), = self.run_both(experiment, {"/brain/rain.cell"}).values()
        self.assertEqual(synapses, 300)
        saved = self.saved("brain.learned.npy").ravel()
        np.testing.assert_array_equal(weights, saved[np.arange(256) * 300 // 256])
        self.assertGreater(np.ptp(weights), 0)

    def test_the_page_shows_the_episodes(self):
        with viewing.Run(self.folder / "run", "--duration", "36000", experiment=self.lake()) as job:
            with browser.page(job.url) as page:
                page.until(lambda hook: hook.get("simulated_s", 0) > 0)
                page.driver.execute_script("const speed = document.getElementById('speed'); speed.value = '0';"
                                           "speed.dispatchEvent(new Event('change'));")
                page.until(lambda hook: hook["learning"]["episodes"] > 12, 180)
                page.click("pause")
                page.until(lambda hook: hook["paused"])
                rows = recordings.table(self.folder / "run/episodes.csv")
                learning = page.until(lambda hook: hook["learning"]["episodes"] == len(rows))["learning"]
                self.assertEqual(learning["returns"], [float(row["return"]) for row in rows])
                self.assertEqual(learning["successes"], sum(row["success"] == "1" for row in rows))
                for name, synapses in (("actor", 64), ("critic", 16)):
                    shown = learning["weights"][f"/brain/input.{name}"]
                    self.assertEqual((shown["synapses"], len(shown["newest"])), (synapses, synapses))
                    self.assertGreater(shown["rows"], 1)
                drawn = page.driver.execute_script("""
                  return ["returns", "weights"].map((name) => {
                    const canvas = document.getElementById(name);
                    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
                    return data.filter((value, i) => i % 4 === 3 && value).length;
                  });""")
                self.assertGreater(min(drawn), 200)
                self.assertEqual(page.complaints(), [])
            job.interrupt()


if __name__ == "__main__":
    unittest.main()
