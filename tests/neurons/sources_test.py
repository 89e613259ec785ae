"""Poisson sources, currents, and the continuous ports against theory."""

import math
import unittest

import numpy as np

import built_in
from built_in import MS

MASK = 2 ** 64 - 1
CELL = {"tau_m": "12 ms", "C_m": "200 pF", "E_L": "-65 mV", "V_th": "1000 mV"}
TAU, CAPACITANCE, REST = 12.0, 200.0, -65.0


def name_hash(text):
    value = 0xcbf29ce484222325
    for byte in text.encode():
        value = ((value ^ byte) * 0x100000001b3) & MASK
    return value


def uniform(seed, name, channel, draws):
    """The numbers that docs/architecture.md says, by NumPy's Philox."""
    bits = []
    for draw in draws:
        counter = (draw // 4) + (channel << 64) - 1  # NumPy counts up before it draws
        generator = np.random.Philox(counter=counter % 2 ** 256,
                                     key=np.array([seed, name_hash(name)],
                                                  dtype=np.uint64))
        bits.append(int(generator.random_raw(draw % 4 + 1)[-1]))
    return np.array([((value >> 11) + 1) * 2.0 ** -53 for value in bits])


def distance_ks(sample, cumulative):
    """Kolmogorov and Smirnov's distance, times the root of the sample's size."""
    sample = np.sort(sample)
    wanted = cumulative(sample)
    steps = np.arange(len(sample) + 1) / len(sample)
    return math.sqrt(len(sample)) * max((steps[1:] - wanted).max(), (wanted - steps[:-1]).max())


class Case(built_in.FolderCase):
    def setUp(self):
        super().setUp()
        self.runs = 0

    def run_network(self, populations, connections=(), seconds=1.0, resolution="0.1 ms", given=None,
                    record=None, **options):
        """With an input of one channel, which makes it a part of the experiment."""
        self.runs += 1
        network = {"resolution": resolution,
                   "populations": {"input": {"model": "input", "size": 1}, **populations},
                   "connections": list(connections), **(record or {})}
        return built_in.run(self.folder / str(self.runs), network, seconds,
                            built_in.spikes(given or []), 1, **options)


class Poisson(Case):
    RATES = [(0.0, 40.0), (500.0, 0.0), (900.0, 200.0), (1800.0, 25.0)]  # ms, Hz
    SECONDS = 3.0

    def noise(self, size=200, rate=None, **options):
        steps = rate or [[f"{time} ms", f"{value} Hz"] for time, value in self.RATES]
        return self.run_network({"noise": {"model": "poisson", "size": size,
                                           "parameters": {"rate": steps}}}, seconds=self.SECONDS,
                                record={"record": {"noise": {"spikes": True}}},
                                **options).spikes("noise")

    def integral(self, times_ms):
        """Expected number of spikes up to a time."""
        begins = [time for time, _ in self.RATES] + [np.inf]
        total = np.zeros_like(times_ms, dtype=float)
        for (begin, rate), end in zip(self.RATES, begins[1:]):
            total += rate * 1e-3 * (np.clip(times_ms, begin, end) - begin)
        return total

    def test_counts_are_the_integral_of_the_rate(self):
        fired = self.noise()
        for begin, end in ((0, 500), (500, 900), (900, 1800), (1800, 3000), (0, 3000)):
            count = ((fired.times_ns > begin * MS) & (fired.times_ns <= end * MS)).sum()
            wanted = 200 * (self.integral(np.array([end])) - self.integral(np.array([begin])))[0]
            self.assertLessEqual(abs(count - wanted), 5 * math.sqrt(wanted))

    def test_intervals_are_exponential_in_the_integral(self):
        fired = self.noise(resolution="off")
        intervals = []
        for channel in range(200):
            train = self.integral(fired.times_ns[fired.channels == channel] / MS)
            intervals.append(np.diff(train, prepend=0.0))
        intervals = np.concatenate(intervals)
        # 3 s hold 230 expected spikes a train: what is cut off at the end weighs nothing.
        self.assertGreater(len(intervals), 30000)
        self.assertLess(distance_ks(intervals, lambda x: 1 - np.exp(-x)), 1.95)  # 1 in 1000

    def test_counts_in_windows_have_the_variance_of_their_mean(self):
        fired = self.noise(size=400, rate="80 Hz")
        counts = np.zeros((400, 60))
        np.add.at(counts, (fired.channels, (fired.times_ns - 1) // (50 * MS)), 1)
        self.assertLess(abs(counts.mean() - 4), 5 * math.sqrt(4 / counts.size))
        fano = counts.var(ddof=1) / counts.mean()
        self.assertLess(abs(fano - 1), 5 * math.sqrt(2 / counts.size))
        rest = counts - counts.mean()
        between = (rest[::2] * rest[1::2]).mean() / counts.var()  # of two members
        behind = (rest[:, 1:] * rest[:, :-1]).mean() / counts.var()  # of two windows
        self.assertLess(abs(between), 5 / math.sqrt(counts.size / 2))
        self.assertLess(abs(behind), 5 / math.sqrt(counts.size))

    def test_the_trains_are_those_of_the_documented_random_numbers(self):
        fired = self.noise(size=3, resolution="off", seed=9)
        for channel in range(3):
            numbers = -np.log(uniform(9, "brain.noise", channel, range(40))).cumsum()
            wanted = np.interp(numbers, self.integral(np.linspace(0, 3000, 3001)),
                               np.linspace(0, 3000, 3001))
            mine = fired.times_ns[fired.channels == channel][:40] / MS
            apart = np.abs(mine - wanted[:len(mine)])
            # A flat piece of the integral has no inverse: a spike there is a step's.
            self.assertGreater(len(mine), 35)
            self.assertLess(np.sort(apart)[:-1].max(), 2e-5)

    def test_no_result_depends_on_the_tick_and_the_grid_rounds_up(self):
        runs = [self.noise(tick=tick) for tick in ("0.5 ms", "10 ms", "50 ms")]
        for other in runs[1:]:
            np.testing.assert_array_equal(runs[0].times_ns, other.times_ns)
            np.testing.assert_array_equal(runs[0].channels, other.channels)
        exact = self.noise(resolution="off")
        order = np.lexsort((exact.channels, built_in.on_grid(exact.times_ns)))
        mine = np.lexsort((runs[0].channels, runs[0].times_ns))
        np.testing.assert_array_equal(built_in.on_grid(exact.times_ns)[order],
                                      runs[0].times_ns[mine])
        np.testing.assert_array_equal(exact.channels[order], runs[0].channels[mine])
        other_seed = self.noise(seed=2)
        self.assertNotEqual(list(other_seed.times_ns[:50]), list(runs[0].times_ns[:50]))


def charged(current, since_ms):
    """What a constant current adds, mV."""
    return current * TAU / CAPACITANCE * (1 - np.exp(-since_ms / TAU))


class Currents(Case):
    def potential(self, populations, connections, seconds=1.0, size=1, model="iaf_psc_exp",
                  cell=None, **options):
        cell = {"model": model, "size": size, "parameters": {**CELL, **(cell or {})}}
        run = self.run_network({"cell": cell, **populations}, connections, seconds,
                               record={"record": {"cell": {"V_m": "all"}}}, **options)
        times, rows = run.potential("cell")
        return times * 1e3, rows

    def test_steps(self):
        steps = [(20.0, 150.0), (70.3, -80.0), (400.0, 0.0)]
        for model in ("iaf_psc_exp", "iaf_psc_delta"):
            times, rows = self.potential(
                {"step": {"model": "step_current", "size": 1, "parameters": {
                    "values": [[f"{time} ms", f"{value} pA"] for time, value in steps]}}},
                [{"from": "step", "to": "cell", "rule": "pairs", "pairs": [[0, 0], [0, 1, -0.5]]}],
                size=3, model=model)
            wanted = np.zeros(len(times))
            before = 0.0
            for time, value in steps:  # each step adds the answer to its jump
                wanted += np.where(times > time, charged(value - before, times - time), 0)
                before = value
            np.testing.assert_allclose(rows[:, 0] - REST, wanted, atol=1e-10)
            np.testing.assert_allclose(rows[:, 1] - REST, -0.5 * wanted, atol=1e-10)
            np.testing.assert_array_equal(rows[:, 2], REST)

    def test_a_sine_is_solved_exactly(self):
        for frequency, phase in ((7.0, 0.0), (180.0, 90.0)):
            times, rows = self.potential(
                {"sine": {"model": "sine_current", "size": 1, "parameters": {
                    "amplitude": "120 pA", "frequency": f"{frequency} Hz", "phase": f"{phase} deg",
                    "offset": "30 pA"}}},
                [{"from": "sine", "to": "cell", "rule": "all_to_all"}], size=2)
            omega, start = 2 * math.pi * frequency * 1e-3, math.radians(phase)
            # C dV/dt = -C V / tau + I: the answer to sin(w t + p), zero at time 0
            gain = 120 / CAPACITANCE / (1 / TAU ** 2 + omega ** 2)
            answer = lambda t: np.sin(omega * t + start) / TAU - omega * np.cos(  # noqa: E731
                omega * t + start)
            wanted = gain * (answer(times) - answer(0.0) * np.exp(-times / TAU)) + charged(30, times)
            for column in rows.T:
                np.testing.assert_allclose(column - REST, wanted, atol=1e-10)

    def test_noise_is_white_and_normal(self):
        times, rows = self.potential(
            {"noise": {"model": "noise_current", "size": 30, "parameters": {
                "mean": "20 pA", "std": "50 pA", "dt": "2 ms"}}},
            [{"from": "noise", "to": "cell", "rule": "one_to_one"}], seconds=4.0, size=30,
            tick="2 ms")
        decay = math.exp(-2 / TAU)
        charge = TAU / CAPACITANCE * (1 - decay)
        before = np.vstack([np.full((1, 30), REST), rows[:-1]]) - REST
        currents = (rows - REST - decay * before) / charge  # what must have flown in each 2 ms
        count = currents.size
        self.assertEqual(count, 60000)
        self.assertLess(abs(currents.mean() - 20), 5 * 50 / math.sqrt(count))
        self.assertLess(abs(currents.std() / 50 - 1), 5 / math.sqrt(2 * count))
        normal = np.vectorize(lambda x: 0.5 * math.erfc(-x / math.sqrt(2)))
        self.assertLess(distance_ks((currents.ravel() - 20) / 50, normal), 1.95)
        rest = (currents - 20) / 50
        self.assertLess(abs((rest[1:] * rest[:-1]).mean()), 5 / math.sqrt(count))
        self.assertLess(abs((rest[:, 1:] * rest[:, :-1]).mean()), 5 / math.sqrt(count))
        # the variance of the potential, once it is stationary
        settled = rows[60:] - REST
        wanted = (50 * TAU / CAPACITANCE) ** 2 * (1 - decay) / (1 + decay)
        samples = settled.size * (1 - decay) / (1 + decay)  # that are independent
        self.assertLess(abs(settled.var() / wanted - 1), 5 * math.sqrt(2 / samples))

    def test_a_step_from_the_start_is_I_e(self):
        cell = {"model": "iaf_psc_exp", "size": 1, "parameters": {"tau_m": "12 ms"}}
        driven = self.run_network(
            {"cell": cell, "step": {"model": "step_current", "size": 1,
                                    "parameters": {"values": "450 pA"}}},
            [{"from": "step", "to": "cell", "rule": "all_to_all"}],
            record={"record": {"cell": {"spikes": True}}}).spikes("cell")
        cell["parameters"]["I_e"] = "450 pA"
        alone = self.run_network({"cell": cell},
                                 record={"record": {"cell": {"spikes": True}}}).spikes("cell")
        self.assertGreater(len(alone.times_ns), 30)
        np.testing.assert_array_equal(driven.times_ns, alone.times_ns)

    def test_nothing_depends_on_the_tick(self):
        populations = {
            "cell": {"model": "iaf_psc_exp", "size": 20, "parameters": {"I_e": "300 pA"}},
            "noise": {"model": "noise_current", "size": 20, "parameters": {"std": "400 pA",
                                                                          "dt": "0.3 ms"}},
            "sine": {"model": "sine_current", "size": 1, "parameters": {"amplitude": "90 pA",
                                                                       "frequency": "11 Hz"}}}
        connections = [{"from": "noise", "to": "cell", "rule": "one_to_one"},
                       {"from": "sine", "to": "cell", "rule": "all_to_all"}]
        runs = [self.run_network(populations, connections, tick=tick,
                                 record={"record": {"cell": {"spikes": True}}}).spikes("cell")
                for tick in ("0.5 ms", "10 ms", "50 ms")]
        self.assertGreater(len(runs[0].times_ns), 200)
        for other in runs[1:]:
            np.testing.assert_array_equal(runs[0].times_ns, other.times_ns)
            np.testing.assert_array_equal(runs[0].channels, other.channels)


class Ports(Case):
    """Current in by port `signal`, membrane potentials out by port `potential`."""

    SIGNAL = (np.array([0.1, 0.2, 0.45]), np.array([[1.0, 0.0], [-0.5, 0.25], [0.0, np.nan]]))

    def network(self):
        return {"populations": {"cell": {"model": "iaf_psc_exp", "size": 3, "parameters": CELL},
                                "drive": {"model": "signal_input", "size": 2},
                                "input": {"model": "input", "size": 1}},
                "connections": [{"from": "drive", "to": "cell", "rule": "pairs", "weight": "200 pA",
                                 "pairs": [[0, 0], [1, 1], [1, 2, -2], [0, 2]]}],
                "potential": ["cell"]}

    def wanted(self, times_ms, late_ms=0.0):
        columns = []
        for factors in ((1, 0), (0, 1), (1, -2)):
            total, before = np.zeros(len(times_ms)), 0.0
            for time, row in zip(self.SIGNAL[0] * 1e3 + late_ms, np.nan_to_num(self.SIGNAL[1])):
                current = 200 * (factors[0] * row[0] + factors[1] * row[1])
                total += np.where(times_ms > time, charged(current - before, times_ms - time), 0)
                before = current
            columns.append(total)
        return np.array(columns).T + REST

    def test_in_one_process(self):
        for tick in ("1 ms", "10 ms"):
            run = built_in.run(self.folder / tick.split()[0], self.network(), 0.8,
                               built_in.spikes([]), 1, signal=self.SIGNAL, tick=tick)
            times, rows = run.signal("potential")
            self.assertEqual(len(times), 800 if tick == "1 ms" else 80)
            np.testing.assert_allclose(rows, self.wanted(times * 1e3), atol=1e-10)

    def test_under_MUSIC(self):
        # A continuous hop between processes takes a tick.
        run = built_in.run(self.folder / "separate", self.network(), 0.8, built_in.spikes([]), 1,
                           signal=self.SIGNAL, arguments=["--layout", "separate"])
        times, rows = run.signal("potential")
        np.testing.assert_allclose(rows, self.wanted(times * 1e3, 1.0), atol=1e-10)

    def test_an_infinite_current_ends_the_run(self):
        signal = (np.array([0.1]), np.array([[0.5, np.inf]]))
        run = built_in.run(self.folder / "inf", self.network(), 0.3, built_in.spikes([]), 1,
                           signal=signal, expect=5)
        self.assertIn("port 'signal': channel 1 is inf; send finite numbers", run.output)


class Records(Case):
    def test_members_at_an_interval(self):
        run = self.run_network({"cell": {"model": "iaf_psc_delta", "size": 5, "parameters": CELL}},
                               [{"from": "input", "to": "cell", "rule": "all_to_all",
                                 "weight": "2 mV", "delay": "1 ms"}], given=[(int(9.5 * MS), 0)],
                               seconds=0.1,
                               record={"record": {"cell": {"V_m": [3, 0], "interval": "10 ms"}}})
        times, rows = run.potential("cell")
        np.testing.assert_allclose(times, np.arange(1, 11) * 0.01)
        self.assertEqual(rows.shape, (10, 2))
        wanted = np.where(times > 0.0105, 2 * np.exp(-(times * 1e3 - 10.5) / TAU), 0)
        np.testing.assert_allclose(rows, REST + np.array([wanted, wanted]).T, atol=1e-12)

    def test_a_recorded_population_can_be_connected(self):
        relay = {"populations": {"input": {"model": "input", "size": 4},
                                 "relay": {"model": "repeater", "size": 4}},
                 "connections": [{"from": "input", "to": "relay", "rule": "one_to_one",
                                  "delay": "3 ms"}], "output": ["relay"]}
        run = self.run_network({"noise": {"model": "poisson", "size": 4,
                                          "parameters": {"rate": "90 Hz"}}}, seconds=0.5,
                               record={"record": {"noise": {"spikes": True}}},
                               sinks={"behind": ({"simulator": "builtin", "network": relay},
                                                 "brain.noise_spikes -> behind.in [4]")})
        sent = run.spikes("noise")
        back = built_in.Run(run.folder, "").stream("out", "behind")
        in_time = sent.times_ns + 3 * MS <= 500 * MS
        self.assertGreater(in_time.sum(), 100)
        np.testing.assert_array_equal(sent.times_ns[in_time] + 3 * MS, back.times_ns)
        np.testing.assert_array_equal(sent.channels[in_time], back.channels)

    def test_an_interval_that_is_no_number_of_ticks(self):
        run = self.run_network({"cell": {"model": "iaf_psc_delta", "size": 1}}, expect=2,
                               tick="2 ms",
                               record={"record": {"cell": {"V_m": "all", "interval": "5 ms"}}})
        built_in.assert_says(run.output, "record of 'cell': ... 5 ms ... 2 ms; ... 6 ms")


if __name__ == "__main__":
    unittest.main()
