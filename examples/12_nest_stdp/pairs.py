#!/usr/bin/python3
"""Twenty channels of 10 spikes a second. Of channels 0 to 9 half of the spikes come together."""
import numpy as np
import spikeloop

with spikeloop.music(spikes_out={"out": 20}) as host:
    random = np.random.default_rng(host.seed)
    trains = []
    together = random.uniform(0, host.duration_s, random.poisson(5 * host.duration_s))
    for channel in range(20):
        alone = random.poisson((5 if channel < 10 else 10) * host.duration_s)
        times = random.uniform(0, host.duration_s, alone)
        if channel < 10:
            times = np.append(times, together + random.uniform(0, 0.002, len(together)))
        trains.append(times)
    times = np.concatenate(trains)
    channels = np.repeat(np.arange(20), [len(train) for train in trains])
    for tick in host:
        now = (times > tick.begin_s) & (times <= tick.end_s)
        tick.send("out", times[now], channels[now])
