import numpy as np
import spikeloop


@spikeloop.node
class MyRateEncoder:
    """Turns each value into regular spikes at a proportional rate"""

    inputs = {"in": spikeloop.Signal(text="Values in [-1, 1], one a channel")}
    outputs = {"out": spikeloop.Spikes(same_as="in", text="One neuron a channel")}
    rate_min = spikeloop.Parameter(0, unit="Hz", minimum=0, text="Firing rate at the input value -1")
    rate_max = spikeloop.Parameter(100, unit="Hz", minimum=0, text="Firing rate at the input value 1")

    def __init__(self, setup):
        self.rate, self.integral, self.count = np.zeros((3, setup.widths["in"]))
        self.since = 0

    def step(self, step):
        x, rate = step.inputs["in"], 0.0
        if x is not None:  # there is a value: spikes a nanosecond
            rate = self.rate_min + (np.clip(x, -1, 1) + 1) / 2 * (self.rate_max - self.rate_min)
            rate = rate / spikeloop.SECOND
        if np.any(rate != self.rate):  # up to here at the old rate, from here at the new one
            self.integral += self.rate * (step.begin - self.since)
            self.rate[:], self.since = rate, step.begin
        # A spike whenever the integral passes a whole number, at the nearest nanosecond.
        reached = np.floor(self.integral + self.rate * (step.end - self.since + 0.5))
        new = np.maximum(reached - self.count, 0).astype(int)
        self.count += new
        channels = np.repeat(np.arange(new.size), new)
        whole = self.count[channels] - np.repeat(np.cumsum(new), new) + np.arange(channels.size) + 1
        times = self.since + np.rint((whole - self.integral[channels]) / self.rate[channels])
        step.emit("out", np.clip(times, step.begin + 1, step.end).astype(int), channels)

    def counters(self):
        return {"spikes": self.count.sum()}
