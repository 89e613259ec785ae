"""Learning synapses of the built-in network against NEST's: the same trains give the same weights.

    nest_stdp_test.py with-music|without-music       which NEST; tests/simulators/nest_jobs.py
"""

import json
import pathlib
import subprocess
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "simulators"))

import built_in  # noqa: E402
import nest_jobs  # noqa: E402
import stdp_test  # noqa: E402
from stdp_test import DELAY_MS, TEACH_MS  # noqa: E402

# In a module's namespace unittest would find the others' tests, too.
Case = stdp_test.Case
END_MS = 1500.0
LAST_MS = 1450.0  # NEST brings a synapse up to date when its source fires


class AgainstNest(Case):
    def trains(self, dopamine=False):
        random = np.random.default_rng(8)
        train = lambda count: np.unique(np.round(random.uniform(5, 1400, count), 1))  # noqa: E731
        pre = [np.append(train(50), LAST_MS) for _ in range(5)]
        post = [train(45) for _ in range(4)]
        post[0] = np.unique(np.append(post[0], np.round(pre[0][2:8] - TEACH_MS - DELAY_MS, 1)))
        return [pre, post] + ([[np.round(train(20), 1)]] if dopamine else [])

    def weights_in_nest(self, model, parameters, trains, tau_minus, weight):
        task = {"resolution_ms": 0.1, "delay_ms": DELAY_MS, "teach_ms": TEACH_MS, "weight": weight,
                "model": model, "parameters": parameters, "tau_minus": tau_minus,
                "duration_ms": END_MS, "reward_delay_ms": 2.5,
                "pre": [list(train) for train in trains[0]],
                "post": [list(train) for train in trains[1]]}
        if len(trains) > 2:
            task["dopamine"] = list(trains[2][0])
        (self.folder / "task.json").write_text(json.dumps(task))
        script = pathlib.Path(__file__).with_name("nest_stdp_alone.py")
        done = subprocess.run(["/usr/bin/python3", "-B", str(script), str(self.folder / "task.json"),
                               str(self.folder / "nest.npy")], capture_output=True, text=True,
                              timeout=120, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return np.load(self.folder / "nest.npy")

    def check(self, model, rule, parameters, weight=20.0, sign=1.0, moved=1.0):
        dopamine = rule["rule"] == "stdp_dopamine"
        trains = self.trains(dopamine)
        tau_minus = 27.0
        net = stdp_test.network(5, 4, {**rule, **parameters, "tau_minus": tau_minus,
                                       "save": "w.npy"},
                                weight=sign * weight, reward="dopamine" if dopamine else None)
        given = stdp_test.joined(*trains)
        _, own = self.learned(net, given, 9 + dopamine, END_MS * 1e-3)
        theirs = self.weights_in_nest(model, parameters, trains, tau_minus, sign * weight)
        np.testing.assert_allclose(own, theirs, rtol=1e-9, atol=1e-9)
        self.assertGreater((np.abs(own - sign * weight) > moved).sum(), 15)

    def test_stdp_synapse(self):
        base = {"tau_plus": 16.0, "lambda": 0.05, "alpha": 1.1, "Wmax": 60.0}
        for mu_plus, mu_minus in ((1.0, 1.0), (0.0, 0.0), (0.4, 0.7)):
            self.check("stdp_synapse", {"rule": "stdp"},
                       {**base, "mu_plus": mu_plus, "mu_minus": mu_minus})
            (self.folder / "run").rename(self.folder / f"run {mu_plus}")

    def test_stdp_synapse_with_its_defaults(self):
        self.check("stdp_synapse", {"rule": "stdp"}, {}, moved=0.2)

    def test_inhibitory(self):
        self.check("stdp_synapse", {"rule": "stdp"}, {"lambda": 0.05, "Wmax": -60.0}, sign=-1.0)

    def test_stdp_dopamine_synapse(self):
        self.check("stdp_dopamine_synapse",
                   {"rule": "stdp_dopamine", "reward": "dopamine", "reward_delay": "2.5 ms"},
                   {"tau_plus": 16.0, "A_plus": 0.2, "A_minus": 0.1, "tau_c": 400.0,
                    "tau_n": 120.0, "b": 0.003, "Wmin": 0.0, "Wmax": 200.0}, weight=70.0)


if __name__ == "__main__":
    nest_jobs.main()
