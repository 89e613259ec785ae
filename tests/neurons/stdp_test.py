"""Learning synapses against their definition: closed forms for pairs of spikes, and sums over all
pairs on random trains, without any trace."""

import json
import os
import shutil
import unittest

import numpy as np

import built_in
from built_in import MS

TEACH_MS = 1.0  # delay of what makes a cell fire
DELAY_MS = 1.5  # of the learning synapses: the dendrite's


def network(sources, cells, plasticity, weight=20.0, resolution="0.1 ms", reward=None,
            teachers=None, extra=None):
    """`sources` learn to drive `cells`; each cell fires when its teacher does, at once."""
    populations = {"input": {"model": "input", "size": sources},
                   "teacher": {"model": "input", "size": teachers or cells},
                   "cell": {"model": "iaf_psc_delta", "size": cells,
                            "parameters": {"t_ref": "0 ms", "V_th": "1000 mV"}}}
    connections = [{"from": "input", "to": "cell", "rule": "all_to_all", "weight": f"{weight} mV",
                    "delay": f"{DELAY_MS} ms", "plasticity": dict(plasticity)},
                   {"from": "teacher", "to": "cell", "rule": "one_to_one", "weight": "1e6 mV",
                    "delay": f"{TEACH_MS} ms"}]
    if reward:
        populations[reward] = {"model": "input" if reward == "dopamine" else "signal_input",
                               "size": 1}
    populations.update(extra or {})
    return {"resolution": resolution, "populations": populations, "connections": connections,
            "record": {"cell": {"spikes": True}}}


def arrays(trains):
    return [np.array(sorted(train), dtype=float) for train in trains]


def joined(*groups):
    """Trains in ms of all channels of port `in`, as spikes."""
    return built_in.spikes([(int(round(time * MS)), channel)
                            for channel, train in enumerate(t for group in groups for t in group)
                            for time in train])


def power(base, exponent):
    return base ** exponent


def stdp_weight(pre, post, w, delay, end, p):
    """The definition, event by event; a trace is the sum over all spikes (or the nearest one)."""
    def trace(spikes, now, tau):
        past = [spike for spike in spikes if spike < now - 1e-6]
        past = past[-1:] if p.get("pairing") == "nearest" else past
        return sum(np.exp((spike - now) / tau) for spike in past)

    arrivals = [time + delay for time in post]
    events = sorted([(time, 0) for time in arrivals] + [(time, 1) for time in pre])
    top = p["Wmax"]
    for now, is_pre in events:
        if now > end + 1e-6:
            break
        x = w / top
        if is_pre:
            x -= p["alpha"] * p["lambda"] * power(x, p["mu_minus"]) * trace(arrivals, now,
                                                                            p["tau_minus"])
        else:
            x += p["lambda"] * power(1 - x, p["mu_plus"]) * trace(pre, now, p["tau_plus"])
        w = top * min(1.0, max(0.0, x))
    return w


class Case(built_in.FolderCase):
    def learned(self, net, given, width, seconds, name="w.npy", **options):
        run = built_in.run(self.folder / "run", net, seconds, given, width, **options)
        return run, run.table(name)


class Window(Case):
    """One pair of spikes: the closed form of the window."""

    def test_every_distance(self):
        distances = [-60, -20, -5, -1, -0.1, 0, 0.1, 1, 5, 20, 60]  # arrival minus pre, ms
        p = {"lambda": 0.1, "alpha": 0.7, "tau_plus": 15, "tau_minus": 30, "Wmax": 100.0}
        for mu_plus, mu_minus in ((0.0, 0.0), (1.0, 1.0), (0.4, 0.4)):
            count = len(distances)
            pre = [[100.0] for _ in distances]
            post = [[100.0 + distance - DELAY_MS - TEACH_MS] for distance in distances]
            rule = {"rule": "stdp", "lambda": 0.1, "alpha": 0.7, "tau_plus": "15 ms",
                    "tau_minus": "30 ms", "Wmax": "100 mV", "mu_plus": mu_plus,
                    "mu_minus": mu_minus, "save": "w.npy"}
            net = network(count, count, rule)
            net["connections"][0]["rule"] = "one_to_one"
            _, table = self.learned(net, joined(pre, post), 2 * count, 0.3)
            for i, distance in enumerate(distances):
                x = 0.2
                if distance > 0:
                    x += p["lambda"] * (1 - x) ** mu_plus * np.exp(-distance / p["tau_plus"])
                elif distance < 0:
                    x -= p["alpha"] * p["lambda"] * x ** mu_minus * np.exp(distance /
                                                                         p["tau_minus"])
                self.assertAlmostEqual(table[i, i], 100 * x, delta=1e-10,
                                       msg=f"{distance} ms, mu {mu_plus}, {mu_minus}")


class RandomTrains(Case):
    """Random trains against the sum over all pairs."""

    def check(self, pairing, resolution_ms, **changes):
        random = np.random.default_rng(5)
        p = {"lambda": 0.05, "alpha": 1.1, "tau_plus": 17.0, "tau_minus": 34.0, "mu_plus": 0.6,
             "mu_minus": 0.8, "Wmax": 50.0, "pairing": pairing, **changes}
        grid = lambda train: np.unique(np.round(train / resolution_ms)) * resolution_ms  # noqa: E731
        pre = [grid(random.uniform(1, 1490, size=60)) for _ in range(4)]
        post = [grid(random.uniform(1, 1490, size=50)) for _ in range(3)]
        post[0] = np.unique(np.concatenate([post[0], pre[0][3:9] - TEACH_MS - DELAY_MS]))
        rule = {"rule": "stdp", "save": "w.json",
                **{key: value for key, value in p.items() if key != "tau"}}
        net = network(4, 3, rule, weight=-20.0 if p["Wmax"] < 0 else 20.0,
                      resolution=f"{resolution_ms} ms")
        tables = []
        for tick in ("0.5 ms", "10 ms", "50 ms"):
            run, table = self.learned(net, joined(pre, post), 7, 1.5, "w.json", tick=tick)
            tables.append(table)
            shutil.rmtree(run.folder.parent)
        self.assertEqual(tables[0], tables[1], "bit for bit, whatever the tick")
        self.assertEqual(tables[0], tables[2], "bit for bit, whatever the tick")
        arrival = [train + TEACH_MS for train in post]
        entries = {(row, column): weight for row, column, weight in tables[0]["entries"]}
        self.assertEqual(len(entries), 12)
        moved = 0
        for (row, column), weight in entries.items():
            start = -20.0 if p["Wmax"] < 0 else 20.0
            wanted = stdp_weight(pre[column], arrival[row], start, DELAY_MS, 1500.0, p)
            self.assertAlmostEqual(weight, wanted, delta=1e-9 * abs(p["Wmax"]))
            moved += abs(weight - start) > 1
        self.assertGreater(moved, 6)

    def test_all_pairs(self):
        self.check("all_to_all", 0.1)

    def test_nearest_pairs(self):
        self.check("nearest", 0.1)

    def test_a_coarse_grid_with_many_coincidences(self):
        self.check("all_to_all", 0.5)

    def test_additive_weights_reach_their_bounds(self):
        self.check("all_to_all", 0.1, mu_plus=0.0, mu_minus=0.0, **{"lambda": 0.4})

    def test_inhibition(self):
        self.check("all_to_all", 0.1, Wmax=-50.0)


def dopamine_weight(pre, post, rewards, signal, w, end, p):
    """dw/dt = c (n + r - b): every interval between events by Gauss's rule of 8 points, with c and n
    as sums over pairs and spikes; bounds at the events."""
    arrivals = np.array([time + DELAY_MS for time in post])
    jumps = []  # of the eligibility
    for now in arrivals:
        past = pre[pre < now - 1e-6]
        jumps.append((now, p["A_plus"] * np.exp((past - now) / p["tau_plus"]).sum()))
    for now in pre:
        past = arrivals[arrivals < now - 1e-6]
        jumps.append((now, -p["A_minus"] * np.exp((past - now) / p["tau_minus"]).sum()))
    jumps = np.array(sorted(jumps))
    nodes, factors = np.polynomial.legendre.leggauss(8)
    times = np.unique(np.concatenate([[0.0, end], jumps[:, 0], rewards,
                                      [time for time, _ in signal]]))
    times = times[times <= end]
    begins, halves = times[:-1], np.diff(times)[:, None] / 2
    at = begins[:, None] + halves * (nodes + 1)

    def sums(events, sizes, tau):
        """What is left at the nodes of an interval of all events up to its begin."""
        left = np.exp((events - at[:, :, None]) / tau, where=(events <= begins[:, None] + 1e-6)[:, None],
                      out=np.zeros((*at.shape, len(events))))
        return left @ sizes

    c = sums(jumps[:, 0], jumps[:, 1], p["tau_c"])
    n = sums(rewards, np.full(len(rewards), 1 / p["tau_n"]), p["tau_n"])
    known = np.searchsorted([time for time, _ in signal], begins + 1e-6, "right")
    r = np.array([0.0, *(value for _, value in signal)])[known, None]
    for change in (halves * factors * c * (n + r - p["b"])).sum(axis=1):
        w = min(p["Wmax"], max(p["Wmin"], w + change))
    return w


class Dopamine(Case):
    P = {"A_plus": 1.0, "A_minus": 1.2, "tau_plus": 20.0, "tau_minus": 25.0, "tau_c": 300.0,
         "tau_n": 80.0, "b": 0.004, "Wmin": 0.0, "Wmax": 200.0}

    def check(self, reward, rewards=(), signal=(), **changes):
        random = np.random.default_rng(11)
        p = {**self.P, **changes}
        # 2.5 s: the synapses are brought up to date without a spike, too
        train = lambda count: np.unique(np.round(random.uniform(1, 2400, count), 1))  # noqa: E731
        pre, post = [train(40) for _ in range(3)], [train(40) for _ in range(2)]
        pre.append(np.array([30.0]))  # long silent
        rule = {"rule": "stdp_dopamine", "save": "w.json", "reward": reward, **p}
        if reward == "dopamine":
            rule["reward_delay"] = "2.5 ms"
        net = network(4, 2, rule, weight=60.0, reward=reward)
        groups = [pre, post] + ([[np.array(rewards)]] if reward == "dopamine" else [])
        width = 6 + (reward == "dopamine")
        given = None
        if signal:
            given = (np.array([time * 1e-3 for time, _ in signal]),
                     np.array([[value] for _, value in signal]))
        run, table = self.learned(net, joined(*groups), width, 2.5, "w.json", signal=given)
        fired = run.spikes("cell")
        moved = 0
        for row, column, weight in table["entries"]:
            cell = fired.times_ns[fired.channels == row] / MS
            np.testing.assert_allclose(cell, post[row] + TEACH_MS)
            wanted = dopamine_weight(pre[column], cell, np.array(rewards) + 2.5, signal, 60.0,
                                     2500.0, p)
            self.assertAlmostEqual(weight, wanted, delta=1e-8)
            moved += abs(weight - 60) > 0.5
        self.assertGreater(moved, 4)
        return [weight for _, _, weight in table["entries"]]

    def test_rewarding_spikes(self):
        self.check("dopamine", [100.0, 101.3, 450.0, 900.0, 902.0, 1500.0, 2300.0])

    def test_weights_are_held_in_their_bounds(self):
        weights = self.check("dopamine", list(np.arange(50.0, 2400.0, 20.0)), A_plus=8.0,
                             Wmin=20.0, Wmax=70.0)
        self.assertTrue({20.0, 70.0} & set(weights), weights)

    def test_a_rewarding_signal(self):
        # a breakpoint of a tick of 1 ms is a tick's begin
        self.check("value", signal=[(50.0, 0.02), (700.0, -0.01), (1400.0, 0.03), (2000.0, 0.0)])

    def test_a_signal_that_changes_in_every_tick(self):
        values = np.random.default_rng(3).normal(0, 0.1, 2400)
        self.check("value", signal=[(float(time), value) for time, value in enumerate(values, 10)],
                   Wmax=70.0)


class Kept(Case):
    def test_learned_weights_are_read_as_weights_again(self):
        random = np.random.default_rng(2)
        pre = [np.unique(np.round(random.uniform(1, 900, 30), 1)) for _ in range(3)]
        post = [np.unique(np.round(random.uniform(1, 900, 30), 1)) for _ in range(2)]
        for name in ("w.npy", "w.json"):
            rule = {"rule": "stdp", "lambda": 0.1, "Wmax": "50 mV", "save": name}
            run, table = self.learned(network(3, 2, rule), joined(pre, post), 5, 1.0, name)
            shutil.copy(run.folder / f"brain.{name}", self.folder / name)
            shutil.rmtree(run.folder.parent)
            net = network(3, 2, rule, weight=1.0)
            net["connections"][0]["rule"] = str(self.folder / name)
            _, again = self.learned(net, joined([[]] * 3, [[]] * 2), 5, 0.1, name)
            shutil.rmtree(self.folder / "run")
            if name.endswith(".npy"):
                np.testing.assert_array_equal(again, table)
                self.assertGreater(np.ptp(table), 1)
            else:
                self.assertEqual(again, table)

    def test_under_MUSIC_the_weights_are_the_same(self):
        random = np.random.default_rng(3)
        pre = [np.unique(np.round(random.uniform(1, 400, 30), 1)) for _ in range(3)]
        post = [np.unique(np.round(random.uniform(1, 400, 30), 1)) for _ in range(2)]
        net = network(3, 2, {"rule": "stdp", "lambda": 0.1, "Wmax": "50 mV", "save": "w.npy"})
        tables = []
        for layout in ("fused", "separate"):
            run, table = self.learned(net, joined(pre, post), 5, 0.5,
                                      arguments=["--layout", layout])
            tables.append(table)
            shutil.rmtree(run.folder.parent)
        np.testing.assert_array_equal(*tables)
        self.assertGreater(np.ptp(tables[0]), 1)

    def test_a_music_file_keeps_them_without_a_run_folder_too(self):
        job = self.folder / "job"
        job.mkdir()
        net = {"populations": {"noise": {"model": "poisson", "size": 3,
                                         "parameters": {"rate": "200 Hz"}},
                               "cell": {"model": "iaf_psc_delta", "size": 2}},
               "connections": [{"from": "noise", "to": "cell", "rule": "all_to_all",
                                "weight": "9 mV", "delay": "1 ms",
                                "plasticity": {"rule": "stdp", "save": "w.npy"}}],
               "output": ["cell"]}
        (job / "net.yaml").write_text(json.dumps(net))
        (job / "job.music").write_text(
            "stoptime=0.5\nseed=4\n[brain]\nnp=1\nbinary=spikeloop-network\nnetwork=net.yaml\n"
            "record=true\n[rate]\nnp=1\nbinary=spikeloop-node\nnode=rate_window\n"
            "brain.out -> rate.in [2]\n")
        for arguments in ((), ("--out", str(self.folder / "out"))):
            built_in.spikeloop("run", "job/job.music", *arguments, cwd=self.folder,
                               env={**os.environ, "SPIKELOOP_OUT": ""})
            self.assertEqual(sorted(path.name for path in job.iterdir()),
                             ["brain.h5", "brain.w.npy", "job.music", "net.yaml"])
        self.assertGreater(np.ptp(np.load(job / "brain.w.npy")), 0.1)
        np.testing.assert_array_equal(np.load(job / "brain.w.npy"),
                                      np.load(self.folder / "out" / "brain.w.npy"))

    def test_a_file_that_cannot_be_written_is_told(self):
        rule = {"rule": "stdp", "save": "w.npy"}
        (self.folder / "run" / "run" / "brain.w.npy").mkdir(parents=True)
        run = built_in.run(self.folder / "run", network(1, 1, rule), 0.1, joined([[]], [[]]), 2,
                           expect=4)
        self.assertIn("brain.w.npy", run.output)
        self.assertIn("Is a directory", run.output)


if __name__ == "__main__":
    unittest.main()
