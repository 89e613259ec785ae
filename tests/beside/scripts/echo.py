"""Sends every spike back, `hesitating` or not: what it answers must not depend on when."""
import random
import time

import spikeloop

with spikeloop.music(spikes_in={"in": None}, spikes_out={"out": None}, hesitating=False) as host:
    for tick in host:
        if host.parameters["hesitating"] and random.random() < 0.02:
            time.sleep(random.uniform(0, 0.02))
        tick.send("out", *tick.spikes("in"))
