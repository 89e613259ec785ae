"""Parts a, b and d: real-time factors."""

import dataclasses
import math

from . import chain, search, simulators, trial

LEAST = 1000  # neurons: where curves begin
RATES_HZ = (1, 2)  # of parts a and d: what the paper's scripts have
COARSE_TICK_MS = 50  # of parts a and b: the laser's period
OUT_OF_TIME = "out of time"
HOPELESS = 0.5  # no second trial below this factor
# More neurons are not built in a time that anyone would wait.
MOST = {"nest": 1_000_000, "neuron": 1_000_000, "brian2": 16_000_000, "builtin": 4_000_000}


@dataclasses.dataclass
class Plan:
    """What is to be measured, of all parts."""
    layouts: list
    simulators: list
    encoders: list
    ticks_ms: list
    rates_hz: list
    trials: int
    steps: int  # of part c
    neurons: int  # of part b
    least: int
    most: int
    duration_s: float
    limit_s: float
    precision: float = search.PRECISION
    again: bool = False


class Sweeps:
    """Measures points as they are asked for; what is known is not measured again."""

    def __init__(self, programs, plan, results, say):
        """say(text): tells how far it is."""
        self._programs, self.plan, self._results, self._say = programs, plan, results, say
        self.deadline = math.inf
        self._fresh = set()  # points that `again` has thrown away already

    def factor(self, setting, trials):
        """The median of so many trials; fewer when the first is hopeless."""
        point = self._results.point(setting.keys())
        if self.plan.again and setting not in self._fresh:
            point["trials"].clear()
        self._fresh.add(setting)
        while len(point["trials"]) < trials:
            if point["trials"] and point["real_time_factor"] < HOPELESS:
                break
            self._say(f"{described(setting)}: trial {len(point['trials']) + 1} of {trials}"
                      + (f", real-time factor {point['real_time_factor']:.3g}"
                         if point["trials"] else ""))
            self._results.add_trial(
                point, trial.run(self._programs, setting, self.plan.limit_s, self.deadline))
        return point["real_time_factor"]

    def largest(self, setting, most):
        """Finds the largest number of neurons in real time for everything else that `setting` has."""
        keys = curve_of(setting)
        self._results.settle(keys)

        def factor(neurons, once):
            return self.factor(dataclasses.replace(setting, neurons=neurons),
                               1 if once else self.plan.trials)
        try:
            found = search.largest(factor, min(self.plan.least, most), most, self.plan.precision)
        except (trial.TrialError, trial.OutOfTime) as error:
            self._results.lacks(keys, *said(error))
            return
        self._results.set_largest(keys, found)

    def part_a(self):
        for layout in self.plan.layouts:
            for simulator in self.plan.simulators:
                for encoder in self.plan.encoders:
                    self._curve(self._setting(layout, encoder, simulator, COARSE_TICK_MS))
        if "nest" in self.plan.simulators and "rate" in self.plan.encoders:
            self._curve(self._setting("alone", "rate", "nest", COARSE_TICK_MS))

    def part_d(self):
        for layout in self.plan.layouts:
            for tick_ms in self.plan.ticks_ms:
                self._curve(self._setting(layout, "rate", "none", tick_ms))

    def part_b(self):
        for layout in self.plan.layouts:
            for rate_hz in self.plan.rates_hz:
                setting = dataclasses.replace(
                    self._setting(layout, "rate", "none", COARSE_TICK_MS),
                    neurons=self.plan.neurons, rate_min_hz=rate_hz, rate_max_hz=rate_hz)
                self._results.settle(setting.keys())
                try:
                    self.factor(setting, self.plan.trials)
                except (trial.TrialError, trial.OutOfTime) as error:
                    self._results.lacks(setting.keys(), *said(error))

    def _curve(self, setting):
        reason = simulators.lacks(setting.simulator, setting.layout, self._programs)
        if reason:
            self._results.lacks(curve_of(setting), reason, False)
        else:
            self.largest(setting, min(self.plan.most, MOST.get(setting.simulator, self.plan.most)))

    def _setting(self, layout, encoder, simulator, tick_ms):
        return chain.Setting(layout, encoder, simulator, tick_ms, 0, *RATES_HZ,
                             self.plan.duration_s)


def curve_of(setting):
    """All that a setting says but the number of neurons."""
    keys = setting.keys()
    del keys["neurons"]
    return keys


def said(error):
    """Why, and whether that is a failure."""
    return (OUT_OF_TIME, False) if isinstance(error, trial.OutOfTime) else (str(error), True)


def described(setting):
    simulator = simulators.NAMES[setting.simulator]
    neurons = f"{setting.neurons:,} {setting.encoder} neurons"
    if setting.layout == "alone":
        return f"{simulator} alone, {setting.neurons:,} neurons"
    rate = f" at {setting.rate_max_hz:g} Hz" if setting.rate_min_hz == setting.rate_max_hz else ""
    return f"{setting.layout}, {simulator}, tick {setting.tick_ms:g} ms, {neurons}{rate}"
