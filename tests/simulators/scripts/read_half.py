#!/usr/bin/python3
"""What arrives, tick by tick: from the script in two hops, and from the source in one."""
import numpy as np
import spikeloop

rows = []
with spikeloop.music(signals_in={"level": None, "half": None}) as host:
    for tick in host:
        values = [tick.signal(port) for port in ("level", "half")]
        rows.append(np.concatenate([np.full(3, np.nan) if v is None else v for v in values]))
np.save("rows.npy", rows)
