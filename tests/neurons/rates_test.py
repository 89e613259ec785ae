"""Rate neurons and their learning against an implementation in NumPy, which keeps every rate of every
step and multiplies by whole matrices."""

import copy
import json
import os
import re
import subprocess
import unittest

import numpy as np

import built_in
from sources_test import uniform

NETWORK = str(built_in.PROGRAMS / "spikeloop-network")
DEFAULTS = {"tau": 10.0, "lambda": 1.0, "sigma": 1.0, "mu": 0.0, "g": 1.0, "theta": 0.0,
            "alpha": np.inf, "beta": 1.0, "rate": 0.0}


def matrix(connection, sizes):
    """[targets, sources]"""
    rows, columns = sizes[connection["to"]], sizes[connection["from"]]
    weight, rule = connection.get("weight", 1.0), connection["rule"]
    if rule == "one_to_one":
        return weight * np.eye(rows)
    if rule == "all_to_all":
        return weight * np.ones((rows, columns))
    if rule == "pairs":
        table = np.zeros((rows, columns))
        for source, target, *factor in connection["pairs"]:
            table[target, source] += weight * (factor[0] if factor else 1.0)
        return table
    return weight * np.load(rule)


def phi(model, p, h):
    if model == "threshold_lin_rate_ipn":
        return np.minimum(np.maximum(p["g"] * (h - p["theta"]), 0.0), p["alpha"])
    if model == "sigmoid_rate_ipn":
        return p["g"] / (1.0 + np.exp(-p["beta"] * (h - p["theta"])))
    return p["g"] * (h - p["theta"])


def reference(network, signals, steps, normal=None):
    """({population: rates at the ends of the steps [steps, members]}, {index of a connection: weights}).
    `signals(population, step)`: what a signal_input has in the step; `normal(population, step)`: the
    normal numbers, where sigma is not 0."""
    h = network["resolution"]
    populations = network["populations"]
    sizes = {name: entry["size"] for name, entry in populations.items()}
    p = {name: {**DEFAULTS, **entry.get("parameters", {})} for name, entry in populations.items()
         if entry["model"].endswith("_rate_ipn")}
    rates = {name: [np.full(sizes[name], p[name]["rate"])] for name in p}

    def at(name, step):
        return rates[name][max(step, 0)]

    weights = [matrix(connection, sizes) for connection in network["connections"]]
    there = [table != 0 for table in weights]
    for step in range(1, steps + 1):
        fresh = {}
        for name, own in p.items():
            total = np.zeros(sizes[name])
            for table, connection in zip(weights, network["connections"]):
                if connection["to"] == name:
                    delay = round(connection.get("delay", 0) / h)
                    source = connection["from"]
                    total += table @ (at(source, step - 1 - delay) if source in p
                                      else signals(source, step))
            leak = own["lambda"] / own["tau"]
            gain = (1 - np.exp(-leak * h)) / own["lambda"] if leak else h / own["tau"]
            fresh[name] = np.exp(-leak * h) * at(name, step - 1) + gain * (
                own["mu"] + phi(populations[name]["model"], own, total))
            if own["sigma"]:
                spread = ((1 - np.exp(-2 * leak * h)) / (2 * own["lambda"]) if leak
                          else h / own["tau"])
                fresh[name] += own["sigma"] * np.sqrt(spread) * normal(name, step)
        for name, values in fresh.items():
            rates[name].append(values)
        for i, connection in enumerate(network["connections"]):
            rule = connection.get("plasticity")
            if rule:
                trace = round(rule.get("trace_delay", h) / h)
                pre = at(connection["from"], step - trace)
                post = at(connection["to"], step - trace + 1)
                change = rule.get("A", 0.01) * h * pre * at(rule["reward"], step)
                learns = there[i] & (post > rule.get("theta", 0.0))[:, None]
                weights[i] = np.where(learns, np.clip(weights[i] + change, rule.get("Wmin", 0.0),
                                                      rule.get("Wmax", 1.0)), weights[i])
    return ({name: np.array(values[1:]) for name, values in rates.items()},
            {i: weights[i] for i, connection in enumerate(network["connections"])
             if "plasticity" in connection})


def rate(model, size, **parameters):
    return {"model": f"{model}_rate_ipn", "size": size, "parameters": parameters}


def signal(size):
    return {"model": "signal_input", "size": size}


def actor_critic(**learning):
    """The network of Jordan, Weidel & Morrison 2019."""
    hebbian = {"rule": "reward_hebbian", "reward": "reward", **learning}
    return {
        "resolution": 1.0,
        "populations": {
            "place": signal(25), "gain": signal(1),
            "input": rate("threshold_lin", 25, tau=1.0, theta=-0.5, sigma=0.0),
            "critic": rate("threshold_lin", 1, tau=0.1, mu=-1.0, theta=-1.0, sigma=0.0),
            "reward": rate("lin", 1, tau=1.0, theta=-0.0999, sigma=0.0),
            "actor": rate("threshold_lin", 3, tau=0.1, sigma=0.05)},
        "connections": [
            {"from": "place", "to": "input", "rule": "one_to_one", "weight": 0.5},
            {"from": "gain", "to": "reward", "rule": "one_to_one", "weight": 0.1},
            {"from": "critic", "to": "reward", "rule": "one_to_one", "weight": 1 - 1 / 20000},
            {"from": "critic", "to": "reward", "rule": "one_to_one", "weight": -1.0, "delay": 1.0},
            {"from": "actor", "to": "actor", "rule": "one_to_one", "weight": 1.2},
            {"from": "actor", "to": "actor", "rule": "all_to_all", "weight": -0.55},
            {"from": "input", "to": "critic", "rule": "all_to_all", "weight": 0.5, "delay": 1.0,
             "plasticity": {**hebbian, "A": 0.125, "theta": -1.0, "Wmin": -1.0, "Wmax": 1.0,
                            "save": "critic.npy"}},
            {"from": "input", "to": "actor", "rule": "all_to_all", "weight": 0.3, "delay": 1.0,
             "plasticity": {**hebbian, "A": 0.25, "theta": 0.1, "Wmin": 0.05, "Wmax": 1.0,
                            "save": "actor.npy"}}],
        "rates": ["input", "critic", "reward", "actor"]}


class Case(built_in.FolderCase):
    def setUp(self):
        super().setUp()
        self.runs = 0

    def run_network(self, network, seconds, **options):
        """{population: rates at the ends of the ticks}, the run. An experiment has a connection, so a
        network without a signal gets one that nothing listens to."""
        self.runs += 1
        if "signal" not in options:
            network = {**network, "populations": {**network["populations"], "unused": signal(1)}}
            options["signal"] = np.array([0.0]), np.array([[1.0]])
        run = built_in.run(self.folder / str(self.runs), network, seconds, **options)
        _, values = run.signal("rates")
        sizes = [network["populations"][name]["size"] for name in network["rates"]]
        parts = np.split(values, np.cumsum(sizes)[:-1], axis=1)
        return dict(zip(network["rates"], parts)), run

    def signals(self, network, seconds, low=-1.0, high=2.0, every=20):
        """Random values that change every so many ms: (times in s, rows), and as the reference asks."""
        inputs = [name for name, entry in network["populations"].items()
                  if entry["model"] == "signal_input"]
        ends = np.cumsum([network["populations"][name]["size"] for name in inputs])
        times = np.arange(0, round(seconds * 1000), every)
        rows = np.random.default_rng(5).uniform(low, high, size=(len(times), ends[-1]))
        h = network["resolution"]

        def value(name, step):
            row = rows[int((step - 1) * h + 1e-9) // every]
            return np.split(row, ends[:-1])[inputs.index(name)]

        return (times * 1e-3, rows), value

    def check(self, network, seconds, normal=None, **options):
        """The reference has the same rates at the ends of the ticks of 1 ms, and the same weights."""
        given, value = self.signals(network, seconds)
        steps = round(seconds * 1000 / network["resolution"])
        wanted, weights = reference(network, value, steps, normal)
        rates, run = self.run_network(network, seconds, signal=given, **options)
        a_tick = round(1 / network["resolution"])
        for name in network["rates"]:
            np.testing.assert_allclose(rates[name], wanted[name][a_tick - 1::a_tick], rtol=1e-12,
                                       atol=1e-12, err_msg=name)
        learned = {}
        for i, table in weights.items():
            learned[i] = run.table(network["connections"][i]["plasticity"]["save"])
            np.testing.assert_allclose(learned[i], table, rtol=0, atol=1e-12)
        return rates, learned


class Models(Case):
    def test_each_model_with_all_its_parameters(self):
        np.save(self.folder / "table.npy", np.random.default_rng(1).uniform(-1, 1, size=(5, 4)))
        for resolution in (0.1, 1.0):
            network = {
                "resolution": resolution,
                "populations": {
                    "drive": signal(4),
                    "linear": rate("lin", 4, tau=5.0, sigma=0.0, mu=0.3, g=0.7, theta=0.2, rate=1.5,
                                   **{"lambda": 0.8}),
                    "bounded": rate("threshold_lin", 5, tau=3.0, sigma=0.0, g=1.5, theta=0.1,
                                    alpha=0.9, rate=-0.5),
                    "soft": rate("sigmoid", 3, tau=8.0, sigma=0.0, g=2.0, beta=3.0, theta=0.4),
                    "integral": rate("lin", 2, tau=50.0, sigma=0.0, g=0.2, **{"lambda": 0.0})},
                "connections": [
                    {"from": "drive", "to": "linear", "rule": "one_to_one"},
                    {"from": "linear", "to": "bounded", "rule": str(self.folder / "table.npy"),
                     "weight": 0.8},
                    {"from": "drive", "to": "bounded", "rule": "pairs", "weight": 0.5,
                     "pairs": [[0, 1], [3, 4, -2.0], [3, 4, 0.5]]},
                    {"from": "bounded", "to": "soft", "rule": "all_to_all", "weight": 0.4,
                     "delay": 3.0},
                    {"from": "bounded", "to": "soft", "rule": "pairs", "pairs": [[2, 1, -1.0]],
                     "delay": 7.0},
                    {"from": "soft", "to": "linear", "rule": "pairs", "delay": 0,
                     "pairs": [[0, 0, -0.5], [0, 0, 0.1], [2, 3, 0.2]]},
                    {"from": "soft", "to": "integral", "rule": "all_to_all", "weight": -0.3,
                     "delay": resolution},
                    {"from": "integral", "to": "integral", "rule": "one_to_one", "weight": -0.2}],
                "rates": ["soft", "linear", "integral", "bounded"]}
            with self.subTest(resolution=resolution):
                rates, _ = self.check(network, 0.4)
                self.assertAlmostEqual(rates["bounded"].max(), 0.9, 6)
                self.assertLess(rates["bounded"].min(), 0.01)
                for name in network["rates"]:
                    self.assertGreater(np.ptp(rates[name]), 0.1, name)

    def test_a_delayed_rate_comes_that_much_later(self):
        network = {"resolution": 1.0,
                   "populations": {"drive": signal(1), "a": rate("lin", 1, tau=1.0, sigma=0.0),
                                   "now": rate("lin", 1, tau=1.0, sigma=0.0),
                                   "later": rate("lin", 1, tau=1.0, sigma=0.0)},
                   "connections": [
                       {"from": "drive", "to": "a", "rule": "one_to_one"},
                       {"from": "a", "to": "now", "rule": "one_to_one"},
                       {"from": "a", "to": "later", "rule": "one_to_one", "delay": 9.0}],
                   "rates": ["now", "later"]}
        rates, _ = self.check(network, 0.1)
        np.testing.assert_array_equal(rates["later"][9:], rates["now"][:-9])
        self.assertGreater(np.ptp(rates["now"]), 0.5)


class Winner(Case):
    def test_one_actor_suppresses_the_others(self):
        network = {"resolution": 1.0,
                   "populations": {"drive": signal(3),
                                   "actor": rate("threshold_lin", 3, tau=0.1, sigma=0.0)},
                   "connections": [
                       {"from": "drive", "to": "actor", "rule": "one_to_one"},
                       {"from": "actor", "to": "actor", "rule": "one_to_one", "weight": 1.2},
                       {"from": "actor", "to": "actor", "rule": "all_to_all", "weight": -0.55}],
                   "rates": ["actor"]}
        given = np.array([0.0]), np.array([[0.9, 1.0, 0.8]])
        rates, _ = self.run_network(network, 0.5, signal=given)
        # x = 1 + (1.2 - 0.55) x
        np.testing.assert_allclose(rates["actor"][-1], [0, 1 / 0.35, 0], rtol=0, atol=1e-3)


class Learning(Case):
    def network(self, low, high, **learning):
        """Without noise. The actors begin with weights between low and high: of equal ones the last bit of a sum
        chooses the winner, and that is another one for each library of linear algebra."""
        network = actor_critic(**learning)
        network["populations"]["actor"]["parameters"]["sigma"] = 0.0
        start = np.random.default_rng(2).uniform(low, high, size=(3, 25))
        np.save(self.folder / "actor.npy", start)
        network["connections"][7].update(rule=str(self.folder / "actor.npy"), weight=1.0)
        return network, start

    def test_the_actor_critic_network_of_the_paper(self):
        network, start = self.network(0.1, 0.5)
        rates, learned = self.check(network, 2.0)
        self.assertGreater(np.abs(learned[7] - start).max(), 0.3)
        self.assertGreater(np.abs(learned[6] - 0.5).max(), 0.3)
        self.assertGreater(np.ptp(rates["reward"]), 1)

    def test_weights_stay_within_their_bounds(self):
        network, _ = self.network(0.26, 0.39)
        network["connections"][7]["plasticity"].update(A=2.0, Wmin=0.25, Wmax=0.4)
        network["connections"][6]["plasticity"].update(A=1.0, Wmin=0.45, Wmax=0.55)
        _, learned = self.check(network, 0.7)
        for table, bounds in ((learned[7], (0.25, 0.4)), (learned[6], (0.45, 0.55))):
            self.assertGreaterEqual(table.min(), bounds[0])
            self.assertLessEqual(table.max(), bounds[1])
            self.assertTrue(set(bounds) & set(table.ravel()), table)

    def test_an_older_trace_long_delays_and_a_fine_grid(self):
        network, start = self.network(0.1, 0.5, trace_delay=4.0)
        network["resolution"] = 0.5
        for connection, delay in ((6, 3.0), (7, 0)):
            network["connections"][connection]["delay"] = delay
            network["connections"][connection]["plasticity"]["A"] = 0.02
        network["connections"][7]["plasticity"]["trace_delay"] = 0.5
        del network["connections"][7]["plasticity"]["theta"]
        _, learned = self.check(network, 0.5)
        self.assertGreater(np.ptp(learned[6]), 0.02)
        self.assertGreater(np.ptp(learned[7] - start), 0.01)

    def test_defaults_and_synapses_that_are_not_there(self):
        network = {"resolution": 1.0,
                   "populations": {"drive": signal(3), "value": signal(1),
                                   "a": rate("lin", 3, tau=2.0, sigma=0.0),
                                   "b": rate("sigmoid", 2, tau=2.0, sigma=0.0),
                                   "reward": rate("lin", 1, tau=1.0, sigma=0.0)},
                   "connections": [
                       {"from": "drive", "to": "a", "rule": "one_to_one"},
                       {"from": "value", "to": "reward", "rule": "one_to_one"},
                       {"from": "a", "to": "b", "rule": "pairs", "weight": 0.5,
                        "pairs": [[0, 0], [2, 0, 0.5], [1, 1]],
                        "plasticity": {"rule": "reward_hebbian", "reward": "reward",
                                       "save": "w.npy"}}],
                   "rates": ["b", "a"]}
        _, learned = self.check(network, 0.6)
        self.assertEqual([learned[2][0, 1], learned[2][1, 0], learned[2][1, 2]], [0, 0, 0])
        self.assertGreater(np.abs(learned[2] - [[0.5, 0, 0.25], [0, 0.5, 0]]).max(), 0.01)


class Noise(Case):
    def test_the_numbers_are_those_that_the_documentation_says(self):
        network = actor_critic()
        network["populations"]["input"]["parameters"]["sigma"] = 0.3
        normals = {}

        def normal(name, step):
            block, k = divmod(step - 1, 4)
            if (name, block) not in normals:
                u = np.array([uniform(7, f"brain.{name}", member, range(4 * block, 4 * block + 4))
                              for member in range(network["populations"][name]["size"])])
                radius = np.sqrt(-2 * np.log(u[:, ::2]))
                normals[name, block] = np.stack([radius * np.cos(2 * np.pi * u[:, 1::2]),
                                                 radius * np.sin(2 * np.pi * u[:, 1::2])], axis=2)
            return normals[name, block][:, k // 2, k % 2]

        self.check(network, 0.1, normal, seed=7)

    def test_mean_and_variance_are_those_of_theory(self):
        # dX = (-lambda X + mu + phi(0)) dt / tau + sigma dW / sqrt(tau)
        size, seconds = 1000, 3.0
        network = {"resolution": 1.0,
                   "populations": {
                       "plain": rate("lin", size, tau=5.0, mu=0.7, sigma=1.3),
                       "steep": rate("threshold_lin", size, tau=2.0, theta=-1.0, sigma=0.4,
                                     **{"lambda": 2.5}),
                       "walk": rate("lin", size, tau=20.0, sigma=0.6, **{"lambda": 0.0})},
                   "rates": ["plain", "steep", "walk"]}
        rates, _ = self.run_network(network, seconds, tick="100 ms")
        for name, mean, variance in (("plain", 0.7, 1.3 ** 2 / 2), ("steep", 0.4, 0.4 ** 2 / 5)):
            sample = rates[name].ravel()  # 100 ms are 20 time constants or more
            self.assertLess(abs(sample.mean() - mean), 4 * np.sqrt(variance / len(sample)), name)
            self.assertLess(abs(sample.var() / variance - 1), 4 * np.sqrt(2 / len(sample)), name)
        walk = rates["walk"][-1]
        self.assertLess(abs(walk.var() / (0.6 ** 2 * 3000 / 20) - 1), 4 * np.sqrt(2 / size))
        correlation = np.corrcoef(rates["plain"][:, :50].T) - np.eye(50)
        self.assertLess(np.abs(correlation.mean()), 0.02, "members are independent")

    def test_neither_rates_nor_weights_depend_on_the_tick(self):
        network = actor_critic()
        network["populations"]["input"]["parameters"]["sigma"] = 0.2
        given, _ = self.signals(network, 1.0)
        ends, tables = [], []
        for tick in (1, 10, 20):
            rates, run = self.run_network(network, 1.0, signal=given, tick=f"{tick} ms")
            ends.append(np.hstack(list(rates.values()))[20 // tick - 1::20 // tick])
            tables.append(run.table("actor.npy"))
        for other in (1, 2):
            np.testing.assert_array_equal(ends[0], ends[other])
            np.testing.assert_array_equal(tables[0], tables[other])
        self.assertGreater(np.ptp(tables[0]), 0.1)

    def test_another_seed_gives_other_rates(self):
        network = {"resolution": 1.0, "populations": {"a": rate("lin", 3)}, "rates": ["a"]}
        first, again, other = (self.run_network(network, 0.1, seed=seed)[0]["a"]
                               for seed in (1, 1, 2))
        np.testing.assert_array_equal(first, again)
        self.assertGreater(np.abs(first - other).min(), 0)
        self.assertGreater(np.abs(first[:, 0] - first[:, 1]).min(), 0, "members have their own")


class Together(Case):
    def test_spiking_neurons_beside_rates_fire_as_they_do_alone(self):
        alone = {"resolution": 1.0,
                 "populations": {"noise": {"model": "poisson", "size": 5, "parameters": {"rate": 200}},
                                 "cell": {"model": "iaf_psc_exp", "size": 3}},
                 "connections": [{"from": "noise", "to": "cell", "rule": "all_to_all", "weight": 400,
                                  "delay": 1,
                                  "plasticity": {"rule": "stdp", "Wmax": 600, "save": "stdp.npy"}}],
                 "potential": ["cell"], "record": {"cell": {"spikes": True}}}
        both = actor_critic()
        given, _ = self.signals(both, 0.5)
        rates, run = self.run_network(both, 0.5, signal=given)
        for key in ("populations", "potential", "record"):
            both[key] = {**alone[key], **both[key]} if key == "populations" else alone[key]
        both["connections"] = both["connections"][:4] + alone["connections"] + both["connections"][4:]
        together, mixed = self.run_network(both, 0.5, signal=given)
        for name, values in rates.items():
            np.testing.assert_array_equal(together[name], values)
        np.testing.assert_array_equal(mixed.table("actor.npy"), run.table("actor.npy"))
        alone["populations"]["unused"] = signal(26)
        apart = built_in.run(self.folder / "alone", alone, 0.5, signal=given)
        for one, other in zip(apart.spikes("cell"), mixed.spikes("cell")):
            np.testing.assert_array_equal(one, other)
        np.testing.assert_array_equal(apart.signal("potential")[1], mixed.signal("potential")[1])
        np.testing.assert_array_equal(apart.table("stdp.npy"), mixed.table("stdp.npy"))
        self.assertGreater(len(mixed.spikes("cell").times_ns), 10)

    def test_under_MUSIC_they_are_the_same(self):
        network = actor_critic()
        network["populations"]["input"]["parameters"].update(mu=-0.2, sigma=0.3)
        given = np.array([0.0]), np.zeros((1, 26))  # another value would come a tick later
        sinks = {"sink": ({"node": "low_pass", "tau": "10 ms"}, "brain.rates -> sink.in [30]")}
        ends = [self.run_network(network, 0.4, signal=given, sinks=sinks, tick="10 ms",
                                 arguments=["--layout", layout])
                for layout in ("fused", "separate")]
        for name in network["rates"]:
            np.testing.assert_array_equal(ends[0][0][name], ends[1][0][name])
        np.testing.assert_array_equal(*(run.table("critic.npy") for _, run in ends))
        self.assertGreater(np.ptp(ends[0][1].table("critic.npy")), 0.01)


SCRIPT = """\
import numpy as np
import spikeloop.network

def make(cells=25):
    net = spikeloop.network.Network(resolution="1 ms")
    net.population("place", "signal_input", cells)
    net.population("gain", "signal_input", 1)
    net.population("input", "threshold_lin_rate_ipn", cells, tau="1 ms", theta=-0.5, sigma=0)
    net.population("critic", "threshold_lin_rate_ipn", 1, tau=0.1, mu=-1, theta=-1, sigma=0)
    net.population("reward", "lin_rate_ipn", 1, tau=1, theta=-0.0999, sigma=0)
    net.population("actor", "threshold_lin_rate_ipn", 3, tau=0.1, sigma=0.05, **{"lambda": 1})
    net.connect("place", "input", 0.5 * np.eye(cells))
    net.connect("gain", "reward", rule="one_to_one", weight=0.1)
    net.connect("critic", "reward", rule="one_to_one", weight=1 - 1 / 20000)
    net.connect("critic", "reward", ([0], [0], [-1.0]), delay="1 ms")
    net.connect("actor", "actor", 1.2 * np.eye(3))
    net.connect("actor", "actor", rule="all_to_all", weight=-0.55)
    hebbian = {"rule": "reward_hebbian", "reward": "reward"}
    net.connect("input", "critic", np.full((1, cells), 0.5), delay=1,
                plasticity={**hebbian, "A": 0.125, "theta": -1, "Wmin": -1, "Wmax": 1, "save": "critic.npy"})
    net.connect("input", "actor", np.full((3, cells), 0.3), delay=1,
                plasticity={**hebbian, "A": 0.25, "theta": 0.1, "Wmin": 0.05, "Wmax": 1, "save": "actor.npy"})
    net.rates("input", "critic")
    net.rates("reward", "actor")
    return net
"""


class Function(Case):
    def test_a_Python_function_makes_the_same_network(self):
        (self.folder / "brain.py").write_text(SCRIPT)
        network = actor_critic()
        given, _ = self.signals(network, 0.4)
        rates, run = self.run_network(network, 0.4, signal=given)
        made = built_in.run(self.folder / "made", str(self.folder / "brain.py"), 0.4, signal=given)
        np.testing.assert_array_equal(made.signal("rates")[1], np.hstack(list(rates.values())))
        for name in ("actor.npy", "critic.npy"):
            np.testing.assert_array_equal(made.table(name), run.table(name))

    def test_the_documentation_has_the_same_network(self):
        page = (built_in.HERE.parents[1] / "docs" / "network-file.md").read_text()
        network = actor_critic()
        given, _ = self.signals(network, 0.4)
        rates, run = self.run_network(network, 0.4, signal=given)
        example = next(block for block in re.findall("```yaml\n(.*?)```", page, re.DOTALL)
                       if "reward_hebbian" in block)
        (self.folder / "page.yaml").write_text(example)
        there = built_in.run(self.folder / "page", str(self.folder / "page.yaml"), 0.4, signal=given)
        np.testing.assert_array_equal(there.signal("rates")[1], rates["actor"])
        for name in ("actor.npy", "critic.npy"):
            np.testing.assert_array_equal(there.table(name), run.table(name))

    def test_an_error_has_the_line_of_the_call(self):
        path = self.folder / "brain.py"
        path.write_text(SCRIPT.replace('net.rates("input", "critic")', 'net.rates("input", "place")'))
        line = SCRIPT[:SCRIPT.index('net.rates("reward"')].count("\n") + 1  # the last one
        done = subprocess.run([NETWORK, "--check", str(path)], capture_output=True, text=True,
                              timeout=60, env=dict(os.environ), check=False)
        self.assertEqual(done.returncode, 2)
        built_in.assert_says(done.stderr, f"{path}:{line}:1: key 'rates': 'place' ... signal_input, ... [SL0405]")

    def test_check_prints_rates(self):
        network = copy.deepcopy(actor_critic())
        (self.folder / "net.yaml").write_text(json.dumps(network))
        done = subprocess.run([NETWORK, "--check", "net.yaml"], capture_output=True, text=True,
                              timeout=60, cwd=self.folder, env=dict(os.environ), check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = [" ".join(line.split()) for line in done.stdout.splitlines()]
        self.assertEqual(lines[0], "net.yaml: resolution 1 ms, port in [0], port out [0], port signal "
                                   "[26], port rates [30]")
        for line in ("actor threshold_lin_rate_ipn 3 rates", "place signal_input 25 signal",
                     "place input one_to_one 25 - 0.5", "critic reward one_to_one 1 1 ms -1",
                     "input actor all_to_all 75 1 ms 0.3, reward_hebbian"):
            self.assertIn(line, lines)


if __name__ == "__main__":
    unittest.main()
