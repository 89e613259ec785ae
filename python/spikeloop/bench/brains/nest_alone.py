#!/usr/bin/python3
"""The parrot neurons of repeat_nest.py in NEST alone, driven at the same rate by one generator.

Prints JSON: seconds to build, seconds to run, spikes. nest.json says what.
"""
import json
import time

begun = time.monotonic()
import nest  # noqa: E402: its import belongs to the time to build

with open("nest.json", encoding="utf-8") as file:
    given = json.load(file)
tick_ms, duration_ms = given["tick_ms"], given["duration_ms"]
nest.set_verbosity("M_ERROR")
nest.SetKernelStatus({"resolution": given["resolution_ms"]})
nest.SetKernelStatus({"min_delay": tick_ms, "max_delay": tick_ms})
step = given["resolution_ms"]
interval = max(step, round(1000 / given["rate_hz"] / step) * step)
times = [k * interval for k in range(1, int(duration_ms / interval) + 1)]
generator = nest.Create("spike_generator", 1, {"spike_times": times})
parrots = nest.Create("parrot_neuron", given["neurons"])
nest.Connect(generator, parrots, "all_to_all", {"delay": tick_ms})
nest.Prepare()
built = time.monotonic()
nest.Run(duration_ms)
done = time.monotonic()
print(json.dumps({"build_s": built - begun, "run_s": done - built,
                  "spikes": len(times) * given["neurons"]}))
